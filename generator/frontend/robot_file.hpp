// A robot's file, whatever format it has.
#pragma once

#include <string>

#include "diagnostics.hpp"
#include "ir/robot_description.hpp"

namespace dalembert::frontend {

// The robot of a URDF; of a .xacro, which the program xacro expands first; or of a .sdf, where this program was built with
// libsdformat. Throws InputError as read_urdf() does, and where what a format needs is not there.
ir::RobotDescription read_robot(const std::string& path, Diagnostics& warnings);

bool is_xacro(const std::string& path);

// What `xacro PATH` prints. Throws InputError where there is no such program, or with what it says.
std::string expanded_xacro(const std::string& path);

}  // namespace dalembert::frontend
