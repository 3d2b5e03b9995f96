// What evaluating a quantity costs, counted in the scalar program, and what a scene and the compiler's passes leave out of it.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "ir/graph.hpp"
#include "ir/program.hpp"
#include "lower.hpp"
#include "pipeline.hpp"

namespace dalembert {

struct OperationCost {
  std::string name;                        // "all", a quantity's name, or "jacobian_" and a link's
  ir::Operations operations;               // of all phases
  std::array<ir::Operations, 3> phases{};  // I: bodies outwards, II: sums inwards, III: elements
  bool reads_position = false;             // joint positions
  bool reads_velocity = false;
  bool reads_base_pose = false;          // of a base that moves
  bool reads_base_position = false;      // and not its orientation alone
  std::vector<int> positions_not_read;   // indices into q
  std::vector<int> velocities_not_read;  // indices into v
};

// Scalar operations of the scene's outputs together ("all", first) and of each alone.
std::vector<OperationCost> operation_costs(const Model& model);
std::vector<OperationCost> operation_costs(const Lowered& lowered, const ir::KinematicTree& tree);

// What there was to leave out: the same URDF without a scene, asked for the default outputs and those of the model, with every
// product and sum that the equations write out (--without fold,share,move_parameters). The base floats where the model's does;
// run-time inputs are constants. Costs as above; empty when the whole robot cannot be computed at all (a joint without mass
// that the scene locks or cuts).
std::vector<OperationCost> costs_before(const Model& model);

// Whether the programs are so large that lowering their robot once more, for costs_before(), would take longer than all the
// rest.
bool too_large_to_compare(const Lowered& lowered);

// The effect of one pass, or of the scene.
struct PassCost {
  std::string name;  // what has been done so far, ending with this
  ir::Operations operations;
};

// The cost of the model's outputs together as one thing after the other is done: as in costs_before(); the scene; then each
// pass that the model's options have.
std::vector<PassCost> pass_costs(const Model& model);

}  // namespace dalembert
