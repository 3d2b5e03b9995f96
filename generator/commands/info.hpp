// `dalembert info`: the robot as the compiler sees it.
#pragma once

#include <string>
#include <vector>

#include "compile.hpp"

namespace dalembert {

// The tree with its joints numbered, the order of coordinates, bodies with masses, the table from link to body, the
// sparsity of M, and the costs.
std::string describe(const Model& model, const std::vector<OperationCost>& costs);

// The same for machines: one JSON object with robot, name, base, nq, nv, joints (those with a coordinate, in order), bodies,
// and quantities by name.
std::string describe_json(const Model& model, const std::vector<OperationCost>& costs);

}  // namespace dalembert
