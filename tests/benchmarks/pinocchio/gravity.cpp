#include <pinocchio/algorithm/rnea.hpp>

#include "robot.hpp"

void run_gravity(dalembert_pinocchio_robot* r, const double* q, const double*, const double*) {
  pinocchio::computeGeneralizedGravity(r->model, r->data, r->position(q));
}

dalembert_pinocchio_result result_of_gravity(const dalembert_pinocchio_robot* r, int) { return result_of(r->data.g); }
