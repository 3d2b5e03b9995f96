#include <pinocchio/algorithm/aba.hpp>

#include "robot.hpp"

void run_forward_dynamics(dalembert_pinocchio_robot* r, const double* q, const double* v, const double* tau) {
  pinocchio::aba(r->model, r->data, r->position(q), r->velocity(v), r->velocity(tau), r->of_forward_dynamics);
}

dalembert_pinocchio_result result_of_forward_dynamics(const dalembert_pinocchio_robot* r, int) {
  return result_of(r->data.ddq);
}
