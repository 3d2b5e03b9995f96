// The generic engine's functions in one scalar, compiled once: with Eigen each file that calls them takes seconds to do so.
//
//   DALEMBERT_GENERIC_ENGINE(extern template, S)   in a header: they are compiled elsewhere
//   DALEMBERT_GENERIC_ENGINE(template, S)          in one source: here
//
// Both in namespace dalembert::generic. This library holds float, double and long double.
#pragma once

#include <dalembert/generic/dynamics.hpp>
#include <dalembert/generic/whole_robot.hpp>

#define DALEMBERT_GENERIC_ENGINE(declaration, S)                                                                       \
  declaration Dynamics<S> evaluate(const Model<S>&, In<S>, In<S>);                                                     \
  declaration MatrixX<S> mass_matrix(const Model<S>&, In<S>);                                                          \
  declaration MatrixX<S> coriolis_matrix(const Model<S>&, In<S>, In<S>);                                               \
  declaration VectorX<S> gravity(const Model<S>&, In<S>);                                                              \
  declaration VectorX<S> bias(const Model<S>&, In<S>, In<S>);                                                          \
  declaration WholeRobot<S> whole_robot(const Model<S>&, In<S>, In<S>);                                                \
  declaration VectorX<S> inverse_dynamics(const Model<S>&, In<S>, In<S>, In<S>, In<S>);                                \
  declaration InverseDynamicsDerivatives<S> inverse_dynamics_derivatives(const Model<S>&, In<S>, In<S>, In<S>, In<S>); \
  declaration MatrixX<S> regressor(const Model<S>&, In<S>, In<S>, In<S>);                                              \
  declaration Solution<MatrixX<S>> inverse_mass_matrix(const Model<S>&, In<S>);                                        \
  declaration Solution<MatrixX<S>> mass_matrix_factor(const Model<S>&, In<S>);                                         \
  declaration Solution<VectorX<S>> forward_dynamics(const Model<S>&, In<S>, In<S>, In<S>, In<S>);                      \
  declaration ForwardDynamicsDerivatives<S> forward_dynamics_derivatives(const Model<S>&, In<S>, In<S>, In<S>, In<S>)

namespace dalembert::generic {
DALEMBERT_GENERIC_ENGINE(extern template, float);
DALEMBERT_GENERIC_ENGINE(extern template, double);
DALEMBERT_GENERIC_ENGINE(extern template, long double);
}  // namespace dalembert::generic
