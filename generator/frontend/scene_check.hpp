// A scene against its robot.
#pragma once

#include "diagnostics.hpp"
#include "ir/robot_description.hpp"
#include "ir/scene.hpp"

namespace dalembert::frontend {

// What `base` means when the user does not say: fixed when the root link is named "world", or when neither it nor a link
// welded to it has an inertia; floating otherwise.
ir::Base default_base(const ir::RobotDescription& robot);

}  // namespace dalembert::frontend
