#include <pinocchio/algorithm/centroidal.hpp>

#include "robot.hpp"

void run_momentum_matrix(dalembert_pinocchio_robot* r, const double* q, const double*, const double*) {
  pinocchio::computeCentroidalMap(r->model, r->data, r->position(q));
}

dalembert_pinocchio_result result_of_momentum_matrix(const dalembert_pinocchio_robot* r, int) { return result_of(r->data.Ag); }
