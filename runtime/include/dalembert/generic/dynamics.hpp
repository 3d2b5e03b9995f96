// The generic engine's interface: the dynamics M v̇ + C v + g = τ of any tree, in any scalar.
//
//   dalembert::generic::Model<double> model = ...;
//   const auto result = dalembert::generic::evaluate(model, q, v);   // result.mass_matrix, result.coriolis_matrix, ...
//
// Scalars: float, double, long double, or Boost.Multiprecision with expression templates off (et_off). For layouts of q and
// v see model.hpp. Arguments of wrong size throw std::invalid_argument. The quaternion must be of unit length.
// Cost: O(n · depth); it allocates (see model.hpp: not the real-time path).
#pragma once

#include <dalembert/generic/forces.hpp>
#include <dalembert/generic/jacobians.hpp>
#include <dalembert/generic/phase3.hpp>
#include <dalembert/generic/reduction.hpp>

namespace dalembert::generic {

// A parameter that takes any Eigen expression convertible to the vector, S being deduced from the model alone.
template <class S>
struct Argument {
  using Vector = VectorX<S>;
};
template <class S>
using In = const typename Argument<S>::Vector&;

template <class S>
struct Dynamics {
  MatrixX<S> mass_matrix;       // M, nv × nv
  MatrixX<S> coriolis_matrix;   // C, nv × nv: Ṁ = C + Cᵀ
  VectorX<S> gravity;           // g, nv
  VectorX<S> bias;              // C v + g, and damping and friction of the joints, nv; by Newton-Euler
  MatrixX<S> wrench_influence;  // W, nv × 6·bodies: transposed body Jacobians, the base's first when it floats
};

namespace detail {

template <class S>
Kinematics<S> kinematics(const Model<S>& model, const Reduction<S>& reduction, const VectorX<S>& q, const VectorX<S>& v) {
  check_size<S>(q, model.nq(), "q");
  check_size<S>(v, model.nv(), "v");
  return phase1<S>(model, reduction.expand_position(q), reduction.expand_velocity(v));
}

}  // namespace detail

// M. Independent of the base's pose.
template <class S>
MatrixX<S> mass_matrix(const Model<S>& model, In<S> q) {
  const Reduction<S> reduction(model);
  const Kinematics<S> kinematics = detail::kinematics<S>(model, reduction, q, VectorX<S>::Zero(model.nv()));
  return reduction.reduce_matrix(phase3_mass_matrix(model, kinematics, phase2(model, kinematics)));
}

// C. Independent of the base's pose.
template <class S>
MatrixX<S> coriolis_matrix(const Model<S>& model, In<S> q, In<S> v) {
  const Reduction<S> reduction(model);
  const Kinematics<S> kinematics = detail::kinematics<S>(model, reduction, q, v);
  return reduction.reduce_matrix(phase3_coriolis_matrix(model, kinematics, phase2(model, kinematics)));
}

// g. Independent of the base's position.
template <class S>
VectorX<S> gravity(const Model<S>& model, In<S> q) {
  const Reduction<S> reduction(model);
  const Kinematics<S> kinematics = detail::kinematics<S>(model, reduction, q, VectorX<S>::Zero(model.nv()));
  return reduction.reduce_rows(expanded_gravity<S>(model, kinematics, q));
}

// τ = M v̇ + C v + g, and damping and friction, by recursive Newton-Euler.
template <class S>
VectorX<S> newton_euler(const Model<S>& model, In<S> q, In<S> v, In<S> v_dot) {
  const Reduction<S> reduction(model);
  const Kinematics<S> kinematics = detail::kinematics<S>(model, reduction, q, v);
  check_size<S>(v_dot, model.nv(), "v_dot");
  return reduction.reduce_rows(
      expanded_newton_euler<S>(model, kinematics, q, reduction.expand_velocity(v), reduction.expand_velocity(v_dot)));
}

// C v + g, and damping and friction, by recursive Newton-Euler: independent of phases II and III.
template <class S>
VectorX<S> bias(const Model<S>& model, In<S> q, In<S> v) {
  return newton_euler<S>(model, q, v, VectorX<S>::Zero(model.nv()));
}

// W.
template <class S>
MatrixX<S> wrench_influence(const Model<S>& model, In<S> q) {
  const Reduction<S> reduction(model);
  const Kinematics<S> kinematics = detail::kinematics<S>(model, reduction, q, VectorX<S>::Zero(model.nv()));
  return reduction.reduce_rows(expanded_wrench_influence(model, kinematics));
}

// Body Jacobian, 6 × nv, of a frame fixed to a body (−1: the base) and placed at `frame` in it: its twist, in the frame's
// axes and at its origin, is J v.
template <class S>
MatrixX<S> link_jacobian(const Model<S>& model, In<S> q, int body, const Transform<S>& frame) {
  if (body < -1 || body >= model.joints())
    throw std::invalid_argument("dalembert::generic: no body " + std::to_string(body) + " in the model");
  const Reduction<S> reduction(model);
  const Kinematics<S> kinematics = detail::kinematics<S>(model, reduction, q, VectorX<S>::Zero(model.nv()));
  return reduction.reduce_columns(expanded_jacobian(model, kinematics, body, frame));
}

// Everything at once, phases I and II shared.
template <class S>
Dynamics<S> evaluate(const Model<S>& model, In<S> q, In<S> v) {
  const Reduction<S> reduction(model);
  const Kinematics<S> kinematics = detail::kinematics<S>(model, reduction, q, v);
  const Composites<S> composites = phase2(model, kinematics);
  const VectorX<S> rates = reduction.expand_velocity(v);
  return {reduction.reduce_matrix(phase3_mass_matrix(model, kinematics, composites)),
          reduction.reduce_matrix(phase3_coriolis_matrix(model, kinematics, composites)),
          reduction.reduce_rows(expanded_gravity<S>(model, kinematics, q)),
          reduction.reduce_rows(expanded_newton_euler<S>(model, kinematics, q, rates, VectorX<S>::Zero(rates.size()))),
          reduction.reduce_rows(expanded_wrench_influence(model, kinematics))};
}

}  // namespace dalembert::generic
