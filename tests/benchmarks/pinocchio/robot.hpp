// A robot as Pinocchio has it. Each call is a file of its own: they take minutes to compile.
#pragma once

#include <pinocchio/multibody/data.hpp>
#include <pinocchio/multibody/model.hpp>

#include "commands/report/pinocchio_calls.h"

struct dalembert_pinocchio_robot {
  using Vector = Eigen::Map<const Eigen::VectorXd>;

  pinocchio::Model model;
  pinocchio::Data data;
  // Of the two ways to go about M and forward dynamics, the one that was faster when the robot was made.
  pinocchio::Convention of_mass_matrix = pinocchio::Convention::WORLD, of_forward_dynamics = pinocchio::Convention::WORLD;

  explicit dalembert_pinocchio_robot(pinocchio::Model made) : model(std::move(made)), data(model) {}
  Vector position(const double* q) const { return {q, model.nq}; }
  Vector velocity(const double* v) const { return {v, model.nv}; }
};

// Rows and columns of a matrix of Eigen's, whichever stands first.
template <class Matrix>
dalembert_pinocchio_result result_of(const Matrix& matrix) {
  const int outer = static_cast<int>(matrix.outerStride());
  return Matrix::IsRowMajor ? dalembert_pinocchio_result{matrix.data(), outer, 1}
                            : dalembert_pinocchio_result{matrix.data(), 1, outer};
}

// The calls, each in a file of its name.
#define PINOCCHIO_CALLS(call)                                                                                           \
  call(mass_matrix, "mass_matrix") call(coriolis_matrix, "coriolis_matrix")                                             \
      call(mass_and_coriolis_matrix, "mass_matrix coriolis_matrix") call(gravity, "gravity") call(bias, "bias")         \
          call(inverse_dynamics, "inverse_dynamics") call(forward_dynamics, "forward_dynamics")                         \
              call(inverse_mass_matrix, "inverse_mass_matrix")                                                          \
                  call(inverse_dynamics_derivatives, "inverse_dynamics_dq inverse_dynamics_dv")                         \
                      call(forward_dynamics_derivatives, "forward_dynamics_dq forward_dynamics_dv inverse_mass_matrix") \
                          call(momentum_matrix, "momentum_matrix")                                                      \
                              call(center_of_mass, "center_of_mass center_of_mass_jacobian")                            \
                                  call(energy, "kinetic_energy potential_energy") call(regressor, "regressor")

#define PINOCCHIO_DECLARE(name, quantities)                                                          \
  void run_##name(dalembert_pinocchio_robot*, const double* q, const double* v, const double* more); \
  dalembert_pinocchio_result result_of_##name(const dalembert_pinocchio_robot*, int which);
PINOCCHIO_CALLS(PINOCCHIO_DECLARE)
#undef PINOCCHIO_DECLARE
