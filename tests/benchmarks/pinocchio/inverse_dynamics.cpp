#include <pinocchio/algorithm/rnea.hpp>

#include "robot.hpp"

void run_inverse_dynamics(dalembert_pinocchio_robot* r, const double* q, const double* v, const double* a) {
  pinocchio::rnea(r->model, r->data, r->position(q), r->velocity(v), r->velocity(a));
}

dalembert_pinocchio_result result_of_inverse_dynamics(const dalembert_pinocchio_robot* r, int) {
  return result_of(r->data.tau);
}
