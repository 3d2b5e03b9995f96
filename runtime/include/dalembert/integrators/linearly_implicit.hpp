// Linearly implicit Euler: one linear system a step, and springs and dampers as stiff as one likes.
#pragma once

#include <Eigen/LU>
#include <dalembert/integrators/linearised.hpp>
#include <dalembert/integrators/motion.hpp>

namespace dalembert::integrators {

// One step of h seconds, of first order: (M + h B + h² K) Δv = h (f − h K v), then the new speeds move the positions, where
// `dynamics.linearised(q, v)` gives M, B, K and f (Linearised); called once. What is stiffer than the step comes to rest
// instead of blowing up (Hairer, Wanner, Solving Ordinary Differential Equations II, IV.7; Baraff, Witkin, SIGGRAPH 1998).
template <class Dynamics, class Q, class V>
void linearly_implicit(Dynamics& dynamics, typename Q::Scalar h, Q& q, V& v) {
  const auto near = dynamics.linearised(q, v);
  using Matrix = decltype(near.mass);
  const Matrix system = near.mass + h * near.damping + (h * h) * near.stiffness;
  v += Eigen::PartialPivLU<Matrix>(system).solve(V(h * (near.force - h * (near.stiffness * v))));
  move(q, V(h * v), q, detail::quaternions_of(dynamics, 0));
}

}  // namespace dalembert::integrators
