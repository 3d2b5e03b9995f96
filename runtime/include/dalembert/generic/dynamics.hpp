// The generic engine's interface: the dynamics M v̇ + C v + g = τ of any tree, in any scalar.
//
//   dalembert::generic::Model<double> model = ...;
//   const auto result = dalembert::generic::evaluate(model, q, v);   // result.mass_matrix, result.coriolis_matrix, ...
//
// Inverse dynamics, its derivatives and the regressor are in inverse_dynamics.hpp; forward dynamics, its derivatives and the
// inverse of M in forward_dynamics.hpp. Both are included here.
//
// Scalars: float, double, long double, or Boost.Multiprecision with expression templates off (et_off). For layouts of q and
// v see model.hpp. Arguments of wrong size throw std::invalid_argument. The quaternion must be of unit length.
// Cost: O(n · depth); it allocates (see model.hpp: not the real-time path).
#pragma once

#include <dalembert/generic/forward_dynamics.hpp>
#include <dalembert/generic/inverse_dynamics.hpp>
#include <dalembert/generic/jacobians.hpp>
#include <dalembert/generic/phase3.hpp>

namespace dalembert::generic {

template <class S>
struct Dynamics {
  MatrixX<S> mass_matrix;       // M, nv × nv
  MatrixX<S> coriolis_matrix;   // C, nv × nv: Ṁ = C + Cᵀ
  VectorX<S> gravity;           // g, nv
  VectorX<S> bias;              // C v + g, and damping, friction and springs of the joints, nv; by Newton-Euler
  MatrixX<S> wrench_influence;  // W, nv × 6·bodies: transposed body Jacobians, the base's first when it floats
};

// M. Independent of the base's pose.
template <class S>
MatrixX<S> mass_matrix(const Model<S>& model, In<S> q) {
  const detail::State<S> at(model, q);
  return at.reduction.reduce_matrix(phase3_mass_matrix(model, at.kinematics, phase2(model, at.kinematics)));
}

// C. Independent of the base's pose.
template <class S>
MatrixX<S> coriolis_matrix(const Model<S>& model, In<S> q, In<S> v) {
  const detail::State<S> at(model, q, v);
  return at.reduction.reduce_matrix(phase3_coriolis_matrix(model, at.kinematics, phase2(model, at.kinematics)));
}

// g. Independent of the base's position.
template <class S>
VectorX<S> gravity(const Model<S>& model, In<S> q) {
  const detail::State<S> at(model, q);
  return at.reduction.reduce_rows(expanded_gravity<S>(model, at.kinematics, at.q));
}

// C v + g, and damping, friction and springs of the joints, by recursive Newton-Euler: independent of phases II and III.
template <class S>
VectorX<S> bias(const Model<S>& model, In<S> q, In<S> v) {
  return inverse_dynamics<S>(model, q, v, VectorX<S>::Zero(model.nv()));
}

// W.
template <class S>
MatrixX<S> wrench_influence(const Model<S>& model, In<S> q) {
  const detail::State<S> at(model, q);
  return at.reduction.reduce_rows(expanded_wrench_influence(model, at.kinematics));
}

// Body Jacobian, 6 × nv, of a frame fixed to a body (−1: the base) and placed at `frame` in it: its twist, in the frame's
// axes and at its origin, is J v.
template <class S>
MatrixX<S> link_jacobian(const Model<S>& model, In<S> q, int body, const Transform<S>& frame) {
  if (body < -1 || body >= model.joints())
    throw std::invalid_argument("dalembert::generic: no body " + std::to_string(body) + " in the model");
  const detail::State<S> at(model, q);
  return at.reduction.reduce_columns(expanded_jacobian(model, at.kinematics, body, frame));
}

// Everything at once, phases I and II shared.
template <class S>
Dynamics<S> evaluate(const Model<S>& model, In<S> q, In<S> v) {
  const detail::State<S> at(model, q, v);
  const Composites<S> composites = phase2(model, at.kinematics);
  const VectorX<S> rest = VectorX<S>::Zero(at.v.size());
  return {at.reduction.reduce_matrix(phase3_mass_matrix(model, at.kinematics, composites)),
          at.reduction.reduce_matrix(phase3_coriolis_matrix(model, at.kinematics, composites)),
          at.reduction.reduce_rows(expanded_gravity<S>(model, at.kinematics, at.q)),
          at.reduction.reduce_rows(expanded_newton_euler<S>(model, at.kinematics, at.q, at.v, rest)),
          at.reduction.reduce_rows(expanded_wrench_influence(model, at.kinematics))};
}

}  // namespace dalembert::generic
