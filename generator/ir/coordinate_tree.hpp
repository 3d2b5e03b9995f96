// Which coordinate of v stands above which: what decides where M and its factors are not zero.
#pragma once

#include <vector>

#include "ir/kinematic_tree.hpp"

namespace dalembert::ir {

// Of a robot without driven joints: the tree of its joints, numbered depth first. The base's stand one above another.
// A coordinate that drives other joints moves several bodies; above it stands then what M's factors, eliminated from the last
// coordinate to the first, tie it to (Liu 1990, elimination trees).
struct CoordinateTree {
  std::vector<int> above;  // per coordinate: the one directly above it, -1: none
  std::vector<int> last;  // per coordinate: the last of those beyond it, which may be itself; with driven joints, not all up to
                          // there are

  int size() const { return static_cast<int>(above.size()); }
  // How many stand above it.
  int depth(int coordinate) const;
};
// Of a part of a robot: empty.
CoordinateTree coordinate_tree(const KinematicTree& tree);
// How many at most stand above one of them.
int most_above(const CoordinateTree& tree);

// Coordinates in a row, each but the first directly below the one before it and alone there: what is solved with M takes them
// together, at most as many as dalembert/chain_shapes.hpp says.
struct Chain {
  int first, count;
};
// Of the coordinates from `first` on, all of them in order.
std::vector<Chain> chains(const CoordinateTree& tree, int first = 0);

}  // namespace dalembert::ir
