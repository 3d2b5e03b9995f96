#include <pinocchio/algorithm/crba.hpp>

#include "robot.hpp"

void run_mass_matrix(dalembert_pinocchio_robot* r, const double* q, const double*, const double*) {
  pinocchio::crba(r->model, r->data, r->position(q), r->of_mass_matrix);
  r->data.M.triangularView<Eigen::StrictlyLower>() = r->data.M.transpose().triangularView<Eigen::StrictlyLower>();
}

dalembert_pinocchio_result result_of_mass_matrix(const dalembert_pinocchio_robot* r, int) { return result_of(r->data.M); }
