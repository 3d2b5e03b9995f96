// A library that has its own use of the robot `one_name`, of which another library has another.
#include "one_name/dynamics.hpp"

template <int locked>
double inertia_of_first_joint();

template <>
double inertia_of_first_joint<LOCKED>() {
  one_name::VectorQ q;
  q << 0.3, 0.2, -0.4;
  one_name::Workspace workspace;
  one_name::evaluate(q, one_name::VectorV::Zero(), workspace);
  return one_name::mass_matrix(workspace)(0, 0);
}
