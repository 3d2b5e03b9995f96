// Sets of joints in few words, for people to read.
#pragma once

#include <string>
#include <vector>

#include "ir/kinematic_tree.hpp"

namespace dalembert::ir {

// Joints with a coordinate of their own, by their numbers behind the base's coordinates, ascending: "left_hip_yaw to
// left_ankle_roll, waist" (in the order of q), or "all joints but waist" where most are in the set.
std::string joints_in_words(const std::vector<int>& numbers, const KinematicTree& tree);

}  // namespace dalembert::ir
