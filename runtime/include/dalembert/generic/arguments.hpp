// How every function of the generic engine begins: arguments checked, driven joints expanded, phase I run.
#pragma once

#include <dalembert/generic/phase1.hpp>
#include <dalembert/generic/reduction.hpp>

namespace dalembert::generic {

// A parameter that takes any Eigen expression convertible to the vector, S being deduced from the model alone.
template <class S>
struct Argument {
  using Vector = VectorX<S>;
};
template <class S>
using In = const typename Argument<S>::Vector&;

namespace detail {

// The state of every joint. Keeps a reference to the model.
template <class S>
struct State {
  Reduction<S> reduction;
  VectorX<S> q, v;  // base, then one entry per joint
  Kinematics<S> kinematics;

  State(const Model<S>& model, const VectorX<S>& q_independent, const VectorX<S>& v_independent) : reduction(model) {
    check_size<S>(q_independent, model.nq(), "q");
    check_size<S>(v_independent, model.nv(), "v");
    q = reduction.expand_position(q_independent);
    v = reduction.expand_velocity(v_independent);
    kinematics = phase1<S>(model, q, v);
  }
  // At rest.
  State(const Model<S>& model, const VectorX<S>& q_independent) : State(model, q_independent, VectorX<S>::Zero(model.nv())) {}

  // Acceleration of every joint, behind the base's.
  VectorX<S> acceleration(const Model<S>& model, const VectorX<S>& v_dot) const {
    check_size<S>(v_dot, model.nv(), "v_dot");
    return reduction.expand_velocity(v_dot);
  }
};

}  // namespace detail

}  // namespace dalembert::generic
