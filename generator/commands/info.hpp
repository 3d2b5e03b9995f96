// `dalembert info`: the robot as the compiler sees it.
#pragma once

#include <string>
#include <vector>

#include "pipeline.hpp"

namespace dalembert {

// What evaluating a quantity costs, and what of the state it reads.
struct QuantityCost {
  std::string name;  // "mass_matrix"; "all" for the scene's outputs together
  int add = 0, multiply = 0, divide = 0, sincos = 0;
  bool reads_position = false;  // any joint position
  bool reads_velocity = false;
  bool reads_base_pose = false;  // base position or orientation
};

// The tree with its joints numbered, the order of coordinates, bodies with masses, the table from link to body, the
// sparsity of M, and the costs.
std::string describe(const Model& model, const std::vector<QuantityCost>& costs);

// The same for machines: one JSON object with robot, name, base, nq, nv, joints (those with a coordinate, in order), bodies,
// and quantities by name.
std::string describe_json(const Model& model, const std::vector<QuantityCost>& costs);

}  // namespace dalembert
