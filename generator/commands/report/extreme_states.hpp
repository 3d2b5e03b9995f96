// Random states made extreme, a kind per case.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "commands/state_file.hpp"
#include "ir/kinematic_tree.hpp"

namespace dalembert::reporting {

struct ExtremeCase {
  std::string name;
  std::function<void(const ir::KinematicTree& tree, State& state)> change;  // of a random state
};

// Those whose results have an exact value to compare with.
const std::vector<ExtremeCase>& extreme_cases();

// First of the joints' entries in q.
inline Eigen::Index first_joint(const ir::KinematicTree& tree) { return tree.floating_base ? 7 : 0; }

}  // namespace dalembert::reporting
