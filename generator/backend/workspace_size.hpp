// How large the emitted struct Workspace is.
#pragma once

#include <cstddef>
#include <vector>

#include "ir/plan.hpp"
#include "ir/program.hpp"
#include "ir/rolled.hpp"
#include "ir/scene.hpp"

namespace dalembert::backend {

// sizeof(Workspace) in bytes: results, run-time inputs and room to work in, each array at a multiple of 64.
std::size_t workspace_bytes(const std::vector<ir::OutputArray>& arrays, const ir::Scene& scene, const ir::Plan& plan,
                            const ir::RolledProgram& rolled);

}  // namespace dalembert::backend
