#include <pinocchio/algorithm/rnea-derivatives.hpp>

#include "robot.hpp"

void run_inverse_dynamics_derivatives(dalembert_pinocchio_robot* r, const double* q, const double* v, const double* a) {
  pinocchio::computeRNEADerivatives(r->model, r->data, r->position(q), r->velocity(v), r->velocity(a));
}

dalembert_pinocchio_result result_of_inverse_dynamics_derivatives(const dalembert_pinocchio_robot* r, int which) {
  return result_of(which == 0 ? r->data.dtau_dq : r->data.dtau_dv);
}
