// Random states made extreme, a kind per case.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "commands/state_file.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/scene.hpp"

namespace dalembert::reporting {

struct ExtremeCase {
  std::string name;
  std::function<void(const ir::KinematicTree& tree, State& state)> change;  // of a random state
  bool large_angles = false;  // those of driven joints are rounded by much before anything is computed from them
};

// Those whose results have an exact value to compare with.
const std::vector<ExtremeCase>& extreme_cases();

// The tree with such offsets that multiplier · q + offset, formed exactly at this state, is what code in the scalar rounds it
// to: once, where product and sum are fused, or twice.
ir::KinematicTree with_rounded_angles(ir::KinematicTree tree, const State& state, ir::ScalarType scalar, bool fused);

// First of the joints' entries in q.
inline Eigen::Index first_joint(const ir::KinematicTree& tree) { return tree.base_positions(); }

}  // namespace dalembert::reporting
