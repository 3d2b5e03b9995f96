// Whether the links' inertias are ones a body can have, and what the scene makes of those that are not.
#pragma once

#include "diagnostics.hpp"
#include "ir/robot_description.hpp"
#include "ir/scene.hpp"

namespace dalembert::frontend {

// Looks at every link that the scene leaves moving (neither cut nor welded to a fixed base). A body's second moments about its
// centre of mass along any direction, and its mass, are not negative: its principal moments a <= b <= c are not negative and
// a + b >= c. Warns where a is negative by rounding only (1e-5 of the link's own c, or 1e-12 of the robot's largest c) or the
// triangle inequality does not hold, and uses the inertia as given; also about point masses. Throws InputError for a really
// negative a and for a negative mass, all of them together.
//
// With `inertia: accept` these are used as given, too, with a warning. With `inertia: repair` an inertia that is no body's is
// replaced by the nearest that is: the same mass, centre and principal axes, negative second moments set to zero (nearest in
// the Frobenius norm of the second moments). A negative mass has none.
void check_inertias(ir::RobotDescription& robot, const ir::Scene& scene, Diagnostics& warnings);

}  // namespace dalembert::frontend
