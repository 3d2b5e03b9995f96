// What functions with embedded loops cost besides what the tree without loops does.
#pragma once

#include "ir/algorithm.hpp"

namespace dalembert::ir {

struct KinematicTree;

// G and, where they move, G' of all linkages.
Operations operations_of_linkages(const KinematicTree& tree, bool moving);
Operations operations_of(const Projected& projected, const KinematicTree& tree);

}  // namespace dalembert::ir
