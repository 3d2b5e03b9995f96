// How long the rod of a loop is.
#pragma once

namespace dalembert::ir {

struct KinematicTree;
struct Loop;

// m: as the loop says, or what lies between its points where all joints are at zero. Its links are in the tree.
double loop_length(const KinematicTree& tree, const Loop& loop);

}  // namespace dalembert::ir
