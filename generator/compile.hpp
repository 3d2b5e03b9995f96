// The back half of the compiler: a Model becomes a scalar program, a plan for its shape, and text.
#pragma once

#include <string>
#include <vector>

#include "backend/output_files.hpp"
#include "ir/graph.hpp"
#include "ir/plan.hpp"
#include "ir/program.hpp"
#include "pipeline.hpp"

namespace dalembert {

struct CompileOptions {
  ir::Form form = ir::Form::automatic;
  bool move_parameters = true;
  bool fold = true;
  bool share = true;
};

// What evaluating a quantity costs, and what of the state it reads.
struct OperationCost {
  std::string name;  // "all", a quantity's name, or "jacobian_" and a link's
  ir::Operations operations;
  bool reads_position = false;   // joint positions
  bool reads_velocity = false;
  bool reads_base_pose = false;  // the floating base's orientation; its position is never read
};

// Scalar operations of the scene's outputs together ("all", first) and of each alone, counted in the scalar program.
std::vector<OperationCost> operation_costs(const Model& model, const CompileOptions& options = {});

// The text of every generated file.
std::vector<backend::OutputFile> compile(const Model& model, const CompileOptions& options);

}  // namespace dalembert
