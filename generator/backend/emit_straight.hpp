// The straight form: the whole robot as one function without a loop.
#pragma once

#include <string>
#include <vector>

#include "backend/code_text.hpp"

namespace dalembert::backend {

// The comment above what is computed for a body: the equation of the sweep, and for whom.
std::string straight_heading(const CodeInput& code, const ir::Tag& tag);

// Statements that compute a program's results from q, v and the workspace.
std::string straight_statements(const CodeInput& code, const ir::Program& program);

// What the statements execute: the program's operations, and sines for whole registers of angles.
ir::Operations straight_operations(const CodeInput& code);

// The function in dynamics.cpp, and the headers it includes.
std::string straight_source(const CodeInput& code, const Symbol& symbol);
std::vector<std::string> straight_includes(const CodeInput& code);

}  // namespace dalembert::backend
