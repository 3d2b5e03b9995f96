// `dalembert generate --package`: a robot's dynamics as a package of its own, which needs neither the generator nor its
// library.
//
//   NAME/                 the generated code
//   include/dalembert/    the headers of the runtime that it includes
//   CMakeLists.txt        the library NAME::NAME, its self-test as a test, and what is installed
//   package.xml           for colcon and ROS
//   README.md             functions, coordinates and figures
#pragma once

#include <string>

#include "pipeline.hpp"

namespace dalembert {

// Writes the package into the folder; returns a line that says so. Throws InputError where the folder cannot be written or
// another's files stand in it, or where the runtime's headers are not found.
std::string generate_package(const Model& model, const std::string& folder);

}  // namespace dalembert
