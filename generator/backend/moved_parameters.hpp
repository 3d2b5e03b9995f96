// For the reader of emitted code: which inertial parameters stand at another body than the URDF's.
#pragma once

#include <string>

#include "backend/emit.hpp"

namespace dalembert::backend {

// A paragraph of comments, with an empty line before it; empty where nothing was moved.
std::string moved_parameters(const CodeInput& code);

}  // namespace dalembert::backend
