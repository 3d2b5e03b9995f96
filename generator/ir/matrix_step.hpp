// What is done to whole matrices once their elements are there, with what it costs.
#pragma once

#include <vector>

#include "ir/graph.hpp"

namespace dalembert::ir {

struct KinematicTree;

struct MatrixStep {
  enum class Kind {
    factor,            // to: U and D of a = M = U D U'; the guard's arrays get D and M's diagonal; room: U D, with padding
    solve,             // to = (U D U')^-1 to, a being U and D as `factor` leaves them
    invert,            // to = (U D U')^-1, a being U (above its diagonal) and b D; room: as `to`, with padding
    negative_product,  // to = -a b: a is the room of an inverse, b is zero where neither of two coordinates is above the other
  };
  Kind kind;
  int a = 0, b = 0, to = 0;  // arrays
  int room = -1;             // likewise
  int first = 0;             // of a product: b's columns before this one are zero

  std::vector<int> read() const;
  std::vector<int> filled() const;
};

// Padding left out, or with it, as the code executes it.
Operations operations_of(const MatrixStep& step, const KinematicTree& tree, bool executed);

}  // namespace dalembert::ir
