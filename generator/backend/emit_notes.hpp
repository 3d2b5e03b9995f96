// The tables behind a robot's header: what stands where, for who has the header alone.
#pragma once

#include <string>

#include "backend/emit.hpp"

namespace dalembert::backend {

// Links and the bodies that they move with, frames of the scene, joints that follow others, and whose rows are whose of
// contacts and loops; as comments.
std::string tables_of_robot(const CodeInput& code);

}  // namespace dalembert::backend
