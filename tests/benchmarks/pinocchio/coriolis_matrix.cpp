#include <pinocchio/algorithm/rnea.hpp>

#include "robot.hpp"

void run_coriolis_matrix(dalembert_pinocchio_robot* r, const double* q, const double* v, const double*) {
  pinocchio::computeCoriolisMatrix(r->model, r->data, r->position(q), r->velocity(v));
}

dalembert_pinocchio_result result_of_coriolis_matrix(const dalembert_pinocchio_robot* r, int) { return result_of(r->data.C); }
