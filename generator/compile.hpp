// The back of the compiler: what a model was lowered to becomes text.
#pragma once

#include <cstddef>

#include "lower.hpp"

namespace dalembert {

// sizeof(Workspace) of the generated code, in bytes.
std::size_t workspace_bytes(const Model& model, const Lowered& lowered);

}  // namespace dalembert
