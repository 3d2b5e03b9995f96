// What is done with rows of constraints once their elements are there, behind all steps with whole matrices: a row each, with
// what it costs.
#pragma once

#include <vector>

#include "ir/graph.hpp"

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

struct ConstraintStep {
  enum class Kind {
    delassus,  // to = J M^-1 J'
    solve,     // to, which is e, becomes M^-1 (e + J' f), and f what makes J to = right
    impact,    // to = v + M^-1 J' f, and f what makes J M^-1 J' f = right
    respond,   // to = N = M^-1 - B J M^-1, as a room of M^-1; forces, if any, = -B'; B = M^-1 J' (J M^-1 J' + R)^-1
    derive,    // to, which is -N efforts, becomes -N efforts - B changes, and forces = B' efforts - (J M^-1 J' + R)^-1 changes
    support,   // to becomes to - J' f, and f = W J_u y what makes it zero at the coordinates u without a motor; no factors
  };
  Kind kind;
  ConstraintPaths paths;
  int solutions = 2;  // proximal steps
  // Arrays: J; M's U, above its diagonal, and D; room to work in.
  int jacobian = 0, factor = 0, pivots = 0, room = 0;
  // Where the base moves, by articulated bodies in U's place: V and J of the coordinates, 6 x nv; of the rows the columns of
  // the base are enough then, and `to` comes to `solve` as L dv/dt without constraints, M = L' D L. −1: by U.
  int gain = -1, joint = -1;
  // support of a base that alone has no motor: 6 x the coordinates above constraints but for the base's, in the order in which
  // constraints name them; of the rows the columns of the base are enough then. −1: by all of J.
  int axes = -1;
  int right = -1;   // solve, impact: per row
  int forces = -1;  // solve, impact, support: per row; respond, derive: rows x nv; −1: nobody asks
  int to = 0;       // derive: −1: nobody asks
  // M^-1 with room (respond), N with room (derive): arrays.
  int inverse = -1;
  // respond: N without room, an output; −1: nobody asks.
  int plain = -1;
  // solve: respond's room, which it leaves its inverse in; −1: nobody goes on with it. respond: whether it is there.
  int response = -1;
  bool inverted = false;
  bool of_forces = false;  // respond: whether derivatives of forces are asked for, here or later
  // derive: nv x nv and rows x nv; and where forces of loops turn with one link and move with another, the factors of what
  // efforts are more, a row each for all of them, and room.
  int efforts = -1, changes = -1, left = -1, turned = -1, turning_room = -1, turning_rows = 0;
  int first = 0;                // derive: efforts' columns before this one are zero, and so far to's
  std::vector<int> undriven{};  // support: the coordinates u

  bool by_limbs() const { return gain >= 0; }
  bool by_wrenches() const { return axes >= 0; }
  std::vector<int> read() const;
  std::vector<int> filled() const;
};

// Padding left out, or with it, as the code executes it.
Operations operations_of(const ConstraintStep& step, const KinematicTree& tree, bool executed);

}  // namespace dalembert::ir
