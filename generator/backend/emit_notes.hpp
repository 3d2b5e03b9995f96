// The tables behind a robot's header: what stands where, for who has the header alone.
#pragma once

#include <string>

#include "backend/emit.hpp"

namespace dalembert::backend {

// As comments: joints that follow others, and whose rows are whose of contacts and loops.
std::string followers_and_constraints(const CodeInput& code);
// … and links, the bodies that they move with, and frames of the scene.
std::string tables_of_robot(const CodeInput& code);

}  // namespace dalembert::backend
