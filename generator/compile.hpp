// The back half of the compiler: a Model becomes a scalar program, a plan for its shape, and text.
#pragma once

#include <string>
#include <vector>

#include "ir/graph.hpp"
#include "pipeline.hpp"

namespace dalembert {

// What evaluating a quantity costs, and what of the state it reads.
struct OperationCost {
  std::string name;  // "all", a quantity's name, or "jacobian_" and a link's
  ir::Operations operations;
  bool reads_position = false;   // joint positions
  bool reads_velocity = false;
  bool reads_base_pose = false;  // the floating base's orientation; its position is never read
};

// Scalar operations of the scene's outputs together ("all", first) and of each alone, counted in the scalar program.
std::vector<OperationCost> operation_costs(const Model& model);

}  // namespace dalembert
