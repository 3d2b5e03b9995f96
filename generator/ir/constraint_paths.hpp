// Rows of constraints: where they stand, and which coordinates move them.
#pragma once

#include <cstddef>
#include <vector>

namespace dalembert::ir {

struct KinematicTree;
struct Scene;

// Where the constraints' rows and the coordinates that move them are.
struct ConstraintPaths {
  std::vector<int> first;  // row of each, and behind the last how many there are
  std::vector<int> path;   // the coordinates above the body of each, or its two bodies, that M's factors tie together, in order
  std::vector<int> begin;  // where each list begins, and behind the last its end
  std::vector<int> linear;  // how many rows of each are linear: those come first
  // Of each list: how many stand above both bodies of a loop, the first of the list, and, counting these, where those above one
  // of them alone end; the others follow. Of a contact: the length.
  std::vector<int> common, split;
  std::vector<int> regularization;  // of each, the component of the input that its first row's is (ir/contact.hpp)

  int count() const { return static_cast<int>(first.size()) - 1; }
  int length(std::size_t c) const { return begin[c + 1] - begin[c]; }
  // Whether the i-th of a list stands above its k-th.
  bool is_above(std::size_t c, int i, int k) const { return i < k && (k < split[c] || i < common[c] || i >= split[c]); }
  int longest() const;
  std::vector<int> moving() const;  // the coordinates above any, each once, as the lists name them
  int block_rows() const;           // of the blocks that rows are solved in
};
ConstraintPaths constraint_paths(const KinematicTree& tree, const Scene& scene);
int constraint_room(const ConstraintPaths& paths);
// Coordinates without a motor: the base's, and those of the scene's passive joints.
std::vector<int> undriven_coordinates(const KinematicTree& tree, const Scene& scene);

}  // namespace dalembert::ir
