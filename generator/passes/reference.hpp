// Whose frame each branch of a fixed base has for its frame of reference in a straight line.
//
// M, C and what is made of them are the same in whichever frame. With the frame of a body a few joints up the chain, poses go
// out from it both ways: fewer joints lie between it and the others, so fewer rotations are full and the last of them comes
// sooner; and constant are the axes of its own joint and of the next. Rounding goes by how far masses are from the frame's
// origin: no body is chosen from which they are farther than from the first, nor one that a slide may take away.
#pragma once

#include <functional>
#include <vector>

#include "ir/algorithm.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/normal_tree.hpp"

namespace dalembert::passes {

// A body of each branch, by which a line is cheapest (UnrollOptions::references); none where the base moves or no sweep has a
// choice. None through whose joints what is asked of a link would go that are not above it. `cost`: of a line by such bodies,
// in any unit.
std::vector<int> reference_bodies(const ir::Algorithm& algorithm, const ir::KinematicTree& tree, const ir::NormalTree& normal,
                                  const std::function<double(const std::vector<int>&)>& cost);

}  // namespace dalembert::passes
