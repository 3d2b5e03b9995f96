// A robot's file, whatever format it has.
#pragma once

#include <string>
#include <vector>

#include "diagnostics.hpp"
#include "ir/robot_description.hpp"

namespace dalembert::frontend {

// The robot of a URDF; of a .xacro, which the program xacro expands first; or of a .sdf, where this program was built with
// libsdformat. Throws InputError as read_urdf() does, and where what a format needs is not there.
ir::RobotDescription read_robot(const std::string& path, Diagnostics& warnings);

// The text of all files that the robot is read from, as RobotDescription has it, with as little work as that takes. Throws
// InputError where xacro fails; of a file that cannot be read the reader says so, and the text is empty.
std::string robot_text(const std::string& path);

// The files that the robot is read from, those that a .xacro includes too, absolute. Throws InputError where xacro fails.
std::vector<std::string> files_of(const ir::RobotDescription& robot);

}  // namespace dalembert::frontend
