// Which coordinate of v stands above which: what decides where M and its factors are not zero.
#pragma once

#include <vector>

#include "ir/kinematic_tree.hpp"

namespace dalembert::ir {

// Of a robot without driven joints, whose coordinates are numbered depth first. The floating base's stand one above another.
struct CoordinateTree {
  std::vector<int> above;  // per coordinate: the one directly above it, -1: none
  std::vector<int> last;   // per coordinate: the last of those beyond it, which may be itself

  int size() const { return static_cast<int>(above.size()); }
  // How many stand above it.
  int depth(int coordinate) const;
};
CoordinateTree coordinate_tree(const KinematicTree& tree);

}  // namespace dalembert::ir
