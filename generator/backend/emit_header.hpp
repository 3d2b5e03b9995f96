// The header of a robot, dynamics.hpp.
#pragma once

#include <cstddef>
#include <string>

#include "backend/emit.hpp"

namespace dalembert::backend {

OutputFile header(const Folder& folder, const std::string& banner);

// sizeof(Workspace) in it: results, run-time inputs and room to work in, each array at a multiple of 64 bytes.
std::size_t workspace_bytes(const Folder& folder);

}  // namespace dalembert::backend
