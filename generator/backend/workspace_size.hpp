// How large the emitted struct Workspace is.
#pragma once

#include <cstddef>

#include "backend/emit.hpp"

namespace dalembert::backend {

// sizeof(Workspace) in bytes: results, run-time inputs and room to work in, each array of results and each of those kept at a
// multiple of 64.
std::size_t workspace_bytes(const CodeInput& code);

}  // namespace dalembert::backend
