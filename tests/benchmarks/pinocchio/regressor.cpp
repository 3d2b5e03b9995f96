#include <pinocchio/algorithm/regressor.hpp>

#include "robot.hpp"

void run_regressor(dalembert_pinocchio_robot* r, const double* q, const double* v, const double* a) {
  pinocchio::computeJointTorqueRegressor(r->model, r->data, r->position(q), r->velocity(v), r->velocity(a));
}

dalembert_pinocchio_result result_of_regressor(const dalembert_pinocchio_robot* r, int) {
  return result_of(r->data.jointTorqueRegressor);
}
