// The implicit midpoint rule: symmetric, of second order, without secular drift of energy.
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <dalembert/integrators/linearised.hpp>
#include <dalembert/integrators/motion.hpp>
#include <limits>

namespace dalembert::integrators {

// One step of h seconds: M (v₁ − v₀) = h f at q₀ · exp(h/2 · v_m) and v_m = (v₀ + v₁)/2, then q₁ = q₀ · exp(h v_m). Solved by
// Newton's method with the matrix M + h/2 B + h²/4 K of the step's beginning, down to rounding. `dynamics.linearised(q, v)`
// gives M, B, K and f (Linearised); called once and then per iteration. Returns whether the iteration converged; where it did
// not within 50 (a step too long for the motion), q and v stay as they were.
template <class Dynamics, class Q, class V>
bool implicit_midpoint(Dynamics& dynamics, typename Q::Scalar h, Q& q, V& v) {
  using Scalar = typename Q::Scalar;
  const auto start = dynamics.linearised(q, v);
  using Matrix = decltype(start.mass);
  const Matrix system = start.mass + (h / 2) * start.damping + (h * h / 4) * start.stiffness;
  const Eigen::PartialPivLU<Matrix> solver(system);
  // Newton's first step from v₀: what the linearised equations say.
  V middle = v + solver.solve(V(h * (start.force - (h / 2) * (start.stiffness * v)))) / 2;
  Q at = q;
  const Scalar start_speed = v.template lpNorm<Eigen::Infinity>();  // the middle one may vanish: stiff joints swing to and fro
  Scalar before = std::numeric_limits<Scalar>::infinity();
  for (int i = 0; i < 50; ++i) {
    move(q, V((h / 2) * middle), at, detail::quaternions_of(dynamics, 0));
    const auto near = dynamics.linearised(at, middle);
    const V correction = solver.solve(V((h / 2) * near.force - near.mass * (middle - v)));
    middle += correction;
    const Scalar size = correction.template lpNorm<Eigen::Infinity>();
    const Scalar scale = std::max(start_speed, middle.template lpNorm<Eigen::Infinity>());
    // Rounding is reached where corrections are tiny; where M is ill-conditioned, as soon as small ones no longer shrink.
    const Scalar epsilon = std::numeric_limits<Scalar>::epsilon();
    if (size <= 2 * epsilon * scale || (size >= before && size <= std::sqrt(epsilon) * scale)) {
      move(q, V(h * middle), q, detail::quaternions_of(dynamics, 0));
      v = 2 * middle - v;
      return true;
    }
    if (!(size < std::numeric_limits<Scalar>::max())) return false;
    before = size;
  }
  return false;
}

}  // namespace dalembert::integrators
