// The back half of the compiler: a Model becomes an algorithm, a scalar program, a plan for its shape, and text.
#pragma once

#include <cstddef>

#include "ir/algorithm.hpp"
#include "ir/normal_tree.hpp"
#include "ir/plan.hpp"
#include "ir/program.hpp"
#include "ir/rolled.hpp"
#include "pipeline.hpp"

namespace dalembert {

// A model on its way to text.
struct Lowered {
  ir::NormalTree normal;
  ir::Algorithm algorithm;
  ir::Program program;  // unrolled
  ir::Plan plan;
  ir::RolledProgram rolled;  // empty for the straight form
};
// Runs the passes, those that the model's options leave in.
Lowered lower(const Model& model);

// sizeof(Workspace) of the generated code, in bytes.
std::size_t workspace_bytes(const Model& model, const Lowered& lowered);

}  // namespace dalembert
