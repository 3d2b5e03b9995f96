// When each sweep can run: the sweeps of a level go through the tree together.
//
// Levels alternate: at even ones the code runs outwards through the tree, at odd ones inwards. At an even level the base's own
// sweeps of that level come first.
#pragma once

#include <vector>

#include "ir/algorithm.hpp"

namespace dalembert::passes {

// Per sweep; over the base alone, always even.
std::vector<int> levels(const ir::Algorithm& algorithm);

// The phase of Shin, Park and Park that a sweep belongs to: 1 bodies outwards, 2 sums inwards, 3 what is made of the sums.
// Numbers beyond the sweeps are pairs, then projections.
std::vector<int> phases(const ir::Algorithm& algorithm);

}  // namespace dalembert::passes
