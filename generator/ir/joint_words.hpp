// Sets of joints in few words, for people to read.
#pragma once

#include <string>
#include <vector>

#include "ir/kinematic_tree.hpp"

namespace dalembert::ir {

// Joints with a coordinate of their own, by their numbers behind the base's coordinates, ascending: "left_hip_yaw to
// left_ankle_roll, waist" (in the order of q), or "all joints but waist" where most are in the set.
std::string joints_in_words(const std::vector<int>& numbers, const KinematicTree& tree);

// Of numbers of q behind the base's, the joints' coordinates that they are: of a joint with a quaternion all, or none where
// some of its numbers are not among them.
std::vector<int> coordinates_at(const std::vector<int>& positions, const KinematicTree& tree);

}  // namespace dalembert::ir
