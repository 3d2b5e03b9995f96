// The straight form: the whole robot as one function without a loop.
#pragma once

#include <string>

#include "backend/emit.hpp"

namespace dalembert::backend {

// The text of dynamics.cpp.
std::string straight_source(const CodeInput& code, const std::string& banner);

}  // namespace dalembert::backend
