#include <pinocchio/algorithm/center-of-mass.hpp>

#include "robot.hpp"

void run_center_of_mass(dalembert_pinocchio_robot* r, const double* q, const double*, const double*) {
  pinocchio::jacobianCenterOfMass(r->model, r->data, r->position(q), false);
}

dalembert_pinocchio_result result_of_center_of_mass(const dalembert_pinocchio_robot* r, int which) {
  return which == 0 ? result_of(r->data.com[0]) : result_of(r->data.Jcom);
}
