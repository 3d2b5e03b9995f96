#include <pinocchio/algorithm/rnea.hpp>

#include "robot.hpp"

void run_bias(dalembert_pinocchio_robot* r, const double* q, const double* v, const double*) {
  pinocchio::nonLinearEffects(r->model, r->data, r->position(q), r->velocity(v));
}

dalembert_pinocchio_result result_of_bias(const dalembert_pinocchio_robot* r, int) { return result_of(r->data.nle); }
