// Calls of the runtime's kernels (ir/kernels.def), and what they are called with.
#pragma once

#include <string>
#include <vector>

#include "backend/code_text.hpp"

namespace dalembert::backend {

// Statements behind the elements: the algorithm's kernels, in order. limbs, axes: declare where rows go up from and along what
// joints feel them, where that is not in arrays.
std::string kernel_statements(const CodeInput& code, const std::string& limbs = "", const std::string& axes = "");
// The runtime's headers that they call.
std::vector<std::string> kernel_includes(const CodeInput& code);

// Whether they factor M; and the function that solves with the factors, empty if the code is to have none.
bool solves(const CodeInput& code);
std::string solve_definition(const CodeInput& code);

}  // namespace dalembert::backend
