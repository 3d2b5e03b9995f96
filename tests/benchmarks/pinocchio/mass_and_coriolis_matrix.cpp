// Pinocchio's C is of Christoffel symbols.
#include <pinocchio/algorithm/rnea.hpp>

#include "robot.hpp"

void run_mass_and_coriolis_matrix(dalembert_pinocchio_robot* r, const double* q, const double* v, const double*) {
  run_mass_matrix(r, q, v, nullptr);
  pinocchio::computeCoriolisMatrix(r->model, r->data, r->position(q), r->velocity(v));
}

dalembert_pinocchio_result result_of_mass_and_coriolis_matrix(const dalembert_pinocchio_robot* r, int which) {
  return result_of(which == 0 ? r->data.M : r->data.C);
}
