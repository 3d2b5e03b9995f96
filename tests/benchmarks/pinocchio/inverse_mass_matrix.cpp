#include <pinocchio/algorithm/aba.hpp>

#include "robot.hpp"

void run_inverse_mass_matrix(dalembert_pinocchio_robot* r, const double* q, const double*, const double*) {
  pinocchio::computeMinverse(r->model, r->data, r->position(q));
  r->data.Minv.triangularView<Eigen::StrictlyLower>() = r->data.Minv.transpose().triangularView<Eigen::StrictlyLower>();
}

dalembert_pinocchio_result result_of_inverse_mass_matrix(const dalembert_pinocchio_robot* r, int) {
  return result_of(r->data.Minv);
}
