// Forward dynamics, its derivatives and the inverse of M: M v̇ + C v + g = τ + W F, solved for v̇ by factorising M.
//
// A robot of which some motion moves no mass (a massless link at the end of a chain), or whose inertias are none, has an M that
// cannot be inverted: every function says so in its status, with the coordinate and its pivot, and returns no numbers.
// F: external wrenches, as in inverse_dynamics.hpp.
#pragma once

#include <dalembert/generic/factorisation.hpp>
#include <dalembert/generic/inverse_dynamics.hpp>
#include <dalembert/generic/phase3.hpp>

namespace dalembert::generic {

namespace detail {

template <class S>
Factorisation<S> factorised(const Model<S>& model, const State<S>& at) {
  return Factorisation<S>(at.reduction.reduce_matrix(phase3_mass_matrix(model, at.kinematics, phase2(model, at.kinematics))));
}

}  // namespace detail

// M⁻¹, nv × nv: also ∂v̇/∂τ.
template <class S>
Solution<MatrixX<S>> inverse_mass_matrix(const Model<S>& model, In<S> q) {
  const detail::State<S> at(model, q);
  const Factorisation<S> factors = detail::factorised(model, at);
  if (!factors.status().ok()) return {{}, factors.status()};
  return {factors.solve(MatrixX<S>::Identity(model.nv(), model.nv())), factors.status()};
}

// M = U D Uᵀ, U unit upper triangular: nv × nv, U above the diagonal, D on it, zero below.
template <class S>
Solution<MatrixX<S>> mass_matrix_factor(const Model<S>& model, In<S> q) {
  const Factorisation<S> factors = detail::factorised(model, detail::State<S>(model, q));
  if (!factors.status().ok()) return {{}, factors.status()};
  return {factors.upper(), factors.status()};
}

// v̇ = M⁻¹ (τ − C v − g + W F), nv (m/s², rad/s²), damping, friction and springs of the joints taken from τ. tau: nv (N, N m),
// the first six on a floating base being a wrench on it in its own axes: zero unless something pushes it.
template <class S>
Solution<VectorX<S>> forward_dynamics(const Model<S>& model, In<S> q, In<S> v, In<S> tau, In<S> wrenches = VectorX<S>()) {
  const detail::State<S> at(model, q, v);
  check_size<S>(tau, model.nv(), "tau");
  detail::check_wrenches<S>(model, wrenches);
  const Factorisation<S> factors = detail::factorised(model, at);
  if (!factors.status().ok()) return {{}, factors.status()};
  const VectorX<S> rest = VectorX<S>::Zero(at.v.size()),
                   bias = at.reduction.reduce_rows(expanded_newton_euler<S>(model, at.kinematics, at.q, at.v, rest, wrenches));
  return {factors.solve(tau - bias), factors.status()};
}

// Both nv × nv, of no elements unless status.ok().
template <class S>
struct ForwardDynamicsDerivatives {
  MatrixX<S> dq, dv;
  FactorStatus<S> status;
};

// ∂v̇/∂q and ∂v̇/∂v of forward_dynamics(): −M⁻¹ ∂τ/∂q and −M⁻¹ ∂τ/∂v of inverse dynamics at the v̇ that forward dynamics gives
// (Carpentier, Mansard, "Analytical derivatives of rigid body dynamics algorithms", RSS 2018). Columns as in
// inverse_dynamics_derivatives(); ∂v̇/∂τ is inverse_mass_matrix().
template <class S>
ForwardDynamicsDerivatives<S> forward_dynamics_derivatives(const Model<S>& model, In<S> q, In<S> v, In<S> tau,
                                                           In<S> wrenches = VectorX<S>()) {
  const Solution<VectorX<S>> v_dot = forward_dynamics<S>(model, q, v, tau, wrenches);
  if (!v_dot.status.ok()) return {{}, {}, v_dot.status};
  const InverseDynamicsDerivatives<S> of_tau = inverse_dynamics_derivatives<S>(model, q, v, v_dot.value, wrenches);
  const Factorisation<S> factors = detail::factorised(model, detail::State<S>(model, q));
  return {factors.solve(-of_tau.dq), factors.solve(-of_tau.dv), v_dot.status};
}

// ∂v̇/∂q alone.
template <class S>
Solution<MatrixX<S>> forward_dynamics_dq(const Model<S>& model, In<S> q, In<S> v, In<S> tau, In<S> wrenches = VectorX<S>()) {
  const auto both = forward_dynamics_derivatives<S>(model, q, v, tau, wrenches);
  return {both.dq, both.status};
}

// ∂v̇/∂v alone.
template <class S>
Solution<MatrixX<S>> forward_dynamics_dv(const Model<S>& model, In<S> q, In<S> v, In<S> tau, In<S> wrenches = VectorX<S>()) {
  const auto both = forward_dynamics_derivatives<S>(model, q, v, tau, wrenches);
  return {both.dv, both.status};
}

}  // namespace dalembert::generic
