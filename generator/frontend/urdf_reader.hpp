// URDF file → RobotDescription. The outline reads every number; urdfdom reads the bare tree, and nothing of it is seen outside
// this reader.
#pragma once

#include <string>

#include "diagnostics.hpp"
#include "frontend/urdf_outline.hpp"
#include "ir/robot_description.hpp"

namespace dalembert::frontend {

// The robot of the file, checked: one tree of known links, finite numbers, unit axes, names that can stand in C++. Inertias are
// as the file has them: passes/inertia_check knows what the scene makes of them. Damping, friction and mimic may be NaN, as
// check_scene knows. Throws InputError with every defect found; appends to `warnings` what is ignored or doubtful.
ir::RobotDescription read_urdf(const std::string& path, Diagnostics& warnings);

// The same for a text; `file` is for the diagnostics.
ir::RobotDescription read_urdf_text(const std::string& file, const std::string& text, Diagnostics& warnings);

// The same of what another reader has outlined.
ir::RobotDescription robot_of(const std::string& file, UrdfOutline outline, Diagnostics& warnings);

}  // namespace dalembert::frontend
