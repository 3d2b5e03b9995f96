// The velocity of the robot's centre of mass, world axes, is Jc v: what a joint moves turns about its axis or slides along it.
#include "passes/quantities/mass_center.hpp"
#include "passes/quantities/quantities.hpp"

namespace dalembert::passes {

void describe_center_of_mass_jacobian(Builder& b, int array) { b.result({array, ir::Layout::columns, center_columns(b)}); }

}  // namespace dalembert::passes
