// Whether the bodies' inertias are ones a body can have, and what the scene makes of those that are not.
#pragma once

#include "diagnostics.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/robot_description.hpp"
#include "ir/scene.hpp"

namespace dalembert::passes {

// Looks at every body of the tree, a fixed base aside: M sees bodies and not the links that are welded together in them. A
// body's second moments about its centre of mass along any direction, and its mass, are not negative: its principal moments
// a <= b <= c are not negative and a + b >= c. Warns where a is negative by rounding only (1e-5 of the body's own c, or 1e-12
// of the robot's largest c) or the triangle inequality does not hold, and uses the inertia as given; also about point masses.
// Throws InputError for a really negative a and for a negative mass, all of them together. Links of which none of this is true
// make a body of which it is not, so a body at fault has links at fault, which are named. Where the body is sound all the same,
// they are warned about and used as given. Masses that cancel are an error whatever the scene says: such a body has no centre
// of mass.
//
// With `inertia: accept` these are used as given, too, with a warning. With `inertia: repair` the inertia of a body that is no
// body's is replaced in the tree by the nearest that is: the same mass, centre and principal axes, negative second moments set
// to zero (nearest in the Frobenius norm of the second moments). A negative mass has none. The description stays as the URDF
// has it.
void check_inertias(const ir::RobotDescription& robot, const ir::Scene& scene, ir::KinematicTree& tree, Diagnostics& warnings);

}  // namespace dalembert::passes
