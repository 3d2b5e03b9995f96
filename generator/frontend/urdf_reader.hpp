// URDF file → RobotDescription. urdfdom reads the model; nothing of it, nor of its messages, is seen outside this reader.
#pragma once

#include <string>

#include "diagnostics.hpp"
#include "ir/robot_description.hpp"

namespace dalembert::frontend {

// The robot of the file, checked: one tree of known links, finite numbers, unit axes, inertias a body can have, names that
// can stand in C++. Throws InputError with every defect found; appends to `warnings` what is ignored or doubtful.
ir::RobotDescription read_urdf(const std::string& path, Diagnostics& warnings);

// The same for a text; `file` is for the diagnostics.
ir::RobotDescription read_urdf_text(const std::string& file, const std::string& text, Diagnostics& warnings);

}  // namespace dalembert::frontend
