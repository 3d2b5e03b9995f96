#include <pinocchio/algorithm/energy.hpp>

#include "robot.hpp"

void run_energy(dalembert_pinocchio_robot* r, const double* q, const double* v, const double*) {
  // Poses and velocities are those of the first.
  pinocchio::computeKineticEnergy(r->model, r->data, r->position(q), r->velocity(v));
  pinocchio::computePotentialEnergy(r->model, r->data);
}

dalembert_pinocchio_result result_of_energy(const dalembert_pinocchio_robot* r, int which) {
  return {which == 0 ? &r->data.kinetic_energy : &r->data.potential_energy, 1, 1};
}
