// SDF file → RobotDescription, by libsdformat. Nothing of it is seen outside this reader.
#pragma once

#include <string>

#include "diagnostics.hpp"
#include "ir/robot_description.hpp"

namespace dalembert::frontend {

// The one model of the file, with the models nested in it, checked as a URDF is. Poses are what libsdformat resolves. A joint
// whose frame is not its child link's gets a massless link between, so that links keep the frames that the file gives them;
// named frames become massless links, too. Throws InputError, also where this program was built without libsdformat; appends to
// `warnings` what is ignored or doubtful, by name.
ir::RobotDescription read_sdf(const std::string& path, Diagnostics& warnings);

}  // namespace dalembert::frontend
