// Inertias of links welded together.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "ir/robot_description.hpp"

namespace dalembert::passes {

// The inertia of a link in the axes and at the origin of the body it is welded to. An identity changes no bit.
ir::Inertia moved(const ir::Inertia& inertia, const Eigen::Isometry3d& placement);

// The inertia of several parts given in one frame. One part, or parts without mass or inertia, change no bit.
// Where masses cancel there is no centre of mass, and check_inertias refuses the robot.
ir::Inertia combined(const std::vector<ir::Inertia>& parts);

}  // namespace dalembert::passes
