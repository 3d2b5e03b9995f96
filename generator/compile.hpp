// The back of the compiler: what a model was lowered to becomes text.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "lower.hpp"

namespace dalembert {

// sizeof(Workspace) of the generated code, in bytes.
std::size_t workspace_bytes(const Model& model, const Lowered& lowered);

// Operations that one call of each generated function executes, padding included (backend/executed.hpp).
std::vector<std::pair<std::string, ir::Operations>> executed_operations(const Model& model, const Lowered& lowered);

}  // namespace dalembert
