// A library that has its own use of the robot `one_name`, of which another library has another.
#include "one_name/batch.hpp"
#include "one_name/dynamics.hpp"
#include "one_name/self_test.hpp"

template <int locked>
double inertia_of_first_joint();
template <int locked>
double inertia_in_batch();
template <int locked>
bool passes_self_test();

template <>
double inertia_of_first_joint<LOCKED>() {
  one_name::VectorQ q;
  q << 0.3, 0.2, -0.4;
  one_name::Workspace workspace;
  one_name::evaluate(q, one_name::VectorV::Zero(), workspace);
  return one_name::mass_matrix(workspace)(0, 0);
}

template <>
double inertia_in_batch<LOCKED>() {
  const double q[] = {0.3, 0.2, -0.4}, v[one_name::nv] = {};
  double matrix[one_name::nv * one_name::nv];
  one_name::Batch batch;
  batch.count = 1, batch.q = q, batch.v = v;
  one_name::BatchResults to;
  to.mass_matrix = matrix;
  return one_name::evaluate_batch(batch, to) == dalembert::BatchError::none ? matrix[0] : 0;
}

template <>
bool passes_self_test<LOCKED>() {
  return one_name::self_test(nullptr);
}
