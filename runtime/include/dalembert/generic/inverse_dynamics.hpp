// Inverse dynamics, its derivatives and its regressor: M v̇ + C v + g = τ + W F, solved for τ.
//
// F, where a function takes it, are external wrenches: 6·bodies numbers in the order of W's columns (the base first when it
// floats, then the model's bodies), each [force; moment] along the axes of the body's own frame and about its origin (N, N m).
// None is the same as all zero. W F is Σ Jᵀ f over the bodies, J a body's Jacobian.
#pragma once

#include <dalembert/generic/arguments.hpp>
#include <dalembert/generic/derivatives.hpp>
#include <dalembert/generic/regressor.hpp>

namespace dalembert::generic {

namespace detail {

template <class S>
void check_wrenches(const Model<S>& model, const VectorX<S>& wrenches) {
  if (wrenches.size() != 0) check_size<S>(wrenches, 6 * model.moving_bodies(), "wrenches");
}

}  // namespace detail

// τ = M v̇ + C v + g − W F, nv (N, N m), and what armature, damping, friction and springs of the joints need, by recursive
// Newton-Euler (Luh, Walker, Paul 1980): neither M nor C is formed. v_dot: nv, as v; the base's part is the rate of v's
// entries, which stand in the base's turning axes (m/s², rad/s²).
template <class S>
VectorX<S> inverse_dynamics(const Model<S>& model, In<S> q, In<S> v, In<S> v_dot, In<S> wrenches = VectorX<S>()) {
  const detail::State<S> at(model, q, v);
  detail::check_wrenches<S>(model, wrenches);
  const VectorX<S> acceleration = at.acceleration(model, v_dot);
  return at.reduction.reduce_rows(expanded_newton_euler<S>(model, at.kinematics, at.q, at.v, acceleration, wrenches));
}

// ∂τ/∂q and ∂τ/∂v of inverse_dynamics(), both nv × nv; ∂τ/∂v̇ is M. Column i is the derivative along v's coordinate i: for the
// floating base, moving and turning it along its own axes with v's entries kept (they are not the derivatives along the
// position's and the quaternion's coordinates). Wrenches are constant along their bodies' axes. Stiffness and damping count, on
// the diagonals of ∂τ/∂q and ∂τ/∂v; friction's derivative counts as zero, as it is wherever no joint stands still. Method:
// derivatives.hpp.
template <class S>
InverseDynamicsDerivatives<S> inverse_dynamics_derivatives(const Model<S>& model, In<S> q, In<S> v, In<S> v_dot,
                                                           In<S> wrenches = VectorX<S>()) {
  const detail::State<S> at(model, q, v);
  detail::check_wrenches<S>(model, wrenches);
  const VectorX<S> acceleration = at.acceleration(model, v_dot);
  const auto full = expanded_derivatives<S>(model, at.kinematics, at.q, at.v, acceleration, wrenches);
  return {at.reduction.reduce_matrix(full.dq), at.reduction.reduce_matrix(full.dv)};
}

// ∂τ/∂q alone.
template <class S>
MatrixX<S> inverse_dynamics_dq(const Model<S>& model, In<S> q, In<S> v, In<S> v_dot, In<S> wrenches = VectorX<S>()) {
  return inverse_dynamics_derivatives<S>(model, q, v, v_dot, wrenches).dq;
}

// ∂τ/∂v alone.
template <class S>
MatrixX<S> inverse_dynamics_dv(const Model<S>& model, In<S> q, In<S> v, In<S> v_dot, In<S> wrenches = VectorX<S>()) {
  return inverse_dynamics_derivatives<S>(model, q, v, v_dot, wrenches).dv;
}

// Y, nv × 10·bodies: Y φ = M v̇ + C v + g for φ = inertial_parameters(model), and for every other φ the same of a robot that has
// those. Armature, damping, friction and springs are no parameters of bodies and are left out: subtract what they need
// (armature · v̇ + damping · v + friction · sign v + stiffness · (q − rest) per joint) from measured τ before comparing it with
// Y φ.
template <class S>
MatrixX<S> regressor(const Model<S>& model, In<S> q, In<S> v, In<S> v_dot) {
  const detail::State<S> at(model, q, v);
  const VectorX<S> acceleration = at.acceleration(model, v_dot);
  return at.reduction.reduce_rows(expanded_regressor<S>(model, at.kinematics, at.q, at.v, acceleration));
}

}  // namespace dalembert::generic
