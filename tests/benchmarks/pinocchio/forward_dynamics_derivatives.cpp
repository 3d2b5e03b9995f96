#include <pinocchio/algorithm/aba-derivatives.hpp>

#include "robot.hpp"

void run_forward_dynamics_derivatives(dalembert_pinocchio_robot* r, const double* q, const double* v, const double* tau) {
  pinocchio::computeABADerivatives(r->model, r->data, r->position(q), r->velocity(v), r->velocity(tau));
  r->data.Minv.triangularView<Eigen::StrictlyLower>() = r->data.Minv.transpose().triangularView<Eigen::StrictlyLower>();
}

dalembert_pinocchio_result result_of_forward_dynamics_derivatives(const dalembert_pinocchio_robot* r, int which) {
  return result_of(which == 0 ? r->data.ddq_dq : which == 1 ? r->data.ddq_dv : r->data.Minv);
}
