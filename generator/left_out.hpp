// The report of what was left out, in words: for the generated header and for `dalembert info`.
#pragma once

#include <string>
#include <vector>

#include "compile.hpp"
#include "costs.hpp"

namespace dalembert {

// Per quantity and phase: operations before and after. Then what was not asked for, the inputs not read and the bytes of the
// workspace. One string per line.
std::vector<std::string> left_out(const Model& model, const Lowered& lowered);

// The inputs the quantity does not depend on, by name: "base pose, positions of all joints but waist, velocities"; empty when
// there is none.
std::string not_read(const OperationCost& cost, const ir::KinematicTree& tree);

}  // namespace dalembert
