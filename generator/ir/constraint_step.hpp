// What is done with rows of constraints once their elements are there, behind all steps with whole matrices: a row each, with what
// it costs.
#pragma once

#include <vector>

#include "ir/graph.hpp"

namespace dalembert::ir {

struct KinematicTree;
struct Scene;

// Where the contacts' rows and the coordinates that move them are.
struct ConstraintPaths {
  std::vector<int> first;  // row of each, and behind the last how many there are
  std::vector<int> path;   // the coordinates above the body of each that M's factors tie together, the tree's root first
  std::vector<int> begin;  // where each list begins, and behind the last its end

  int count() const { return static_cast<int>(first.size()) - 1; }
  int longest() const;
  int block_rows() const;  // of the blocks that rows are solved in
};
ConstraintPaths constraint_paths(const KinematicTree& tree, const Scene& scene);
int constraint_room(const ConstraintPaths& paths);

struct ConstraintStep {
  enum class Kind {
    delassus,  // to = J M^-1 J'
    solve,     // to, which is e, becomes M^-1 (e + J' f), and f what makes J to = right
    impact,    // to = v + M^-1 J' f, and f what makes J M^-1 J' f = right
  };
  Kind kind;
  ConstraintPaths paths;
  int solutions = 2;  // proximal steps
  // Arrays: J; M's U, above its diagonal, and D; room to work in.
  int jacobian = 0, factor = 0, pivots = 0, room = 0;
  int right = -1;   // solve, impact: per row
  int forces = -1;  // likewise
  int to = 0;

  std::vector<int> read() const;
};

// Padding left out, or with it, as the code executes it.
Operations operations_of(const ConstraintStep& step, const KinematicTree& tree, bool executed);

}  // namespace dalembert::ir
