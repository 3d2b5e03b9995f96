// The straight form: the whole robot as one function without a loop.
#pragma once

#include <string>

#include "backend/emit.hpp"

namespace dalembert::backend {

// Statements that compute a program's results from q, v and the workspace.
std::string straight_statements(const CodeInput& code, const ir::Program& program);

// The text of dynamics.cpp.
std::string straight_source(const CodeInput& code, const std::string& banner);

}  // namespace dalembert::backend
