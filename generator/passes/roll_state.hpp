// What the parts of rolling share while they build a program.
#pragma once

#include <map>
#include <set>
#include <utility>
#include <vector>

#include "ir/algorithm.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/plan.hpp"
#include "ir/rolled.hpp"
#include "ir/scene.hpp"
#include "passes/unroll.hpp"

namespace dalembert::passes {

using RoleComponent = std::pair<int, int>;

// A sweep, or the products with the base's coordinates that the rolled form keeps per joint.
struct RollStep {
  int sweep = -1;
  int pairs = -1;  // sweep −1: of these pairs
  int level = 0;
};

struct RollState {
  const ir::Algorithm& algorithm;
  Unroll& unroll;
  const ir::KinematicTree& tree;
  const ir::Scene& scene;
  const ir::Plan& plan;
  const ir::Graph::Options options;

  std::vector<int> level;                             // per sweep
  std::vector<int> coordinates = tree.coordinates();  // per body
  std::vector<RollStep> steps{};                      // what bodies do, in order
  std::vector<bool> in_place{};                       // per role: what limbs hand on may be added to what is kept of it
  std::map<ir::NodeId, RoleComponent> base_values{};  // nodes of the unrolled program that are kept for the base from the start
  std::map<int, int> added_parameters{};              // parameter → role
  std::vector<std::vector<int>> children{};           // per body + 1: bodies attached by the start of a limb of another segment
  std::vector<bool> inertial{};                       // per role: of inertia, so that places without a body must have it zero
  std::vector<int> handed_level{};                    // per role: the level at which it is handed on, −1: never
  std::vector<std::map<RoleComponent, int>>
      stored{};                                 // per segment: what paragraphs store that is no constant, and their level
  std::set<RoleComponent> base_needs{};         // what segments read of the base
  std::vector<std::set<RoleComponent>> read{};  // per segment: what is read of its slots
  ir::RolledProgram program{};

  const ir::Role& role(int id) const { return program.roles[static_cast<std::size_t>(id)]; }
  bool constant(ir::NodeId node) const { return node == ir::no_node || unroll.program().graph.is_constant(node); }
  double value(ir::NodeId node) const { return node == ir::no_node ? 0 : unroll.program().graph[node].value; }
  const ir::OutputArray& array(int id) const { return algorithm.arrays[static_cast<std::size_t>(id)]; }
  // Whether the matrix has rows and columns of the base.
  bool has_base_rows(const ir::Pairs& p) const { return tree.base_coordinates() > 0 && array(p.array).row(0) >= 0; }
  // Whether an array has the row, or the column, of a body's coordinate.
  bool asked(int id, bool along_rows, int body) const {
    const int coordinate = tree.base_coordinates() + coordinates[static_cast<std::size_t>(body)];
    return (along_rows ? array(id).row(coordinate) : array(id).column(coordinate)) >= 0;
  }
  bool known(int id) const { return static_cast<std::size_t>(id) < algorithm.roles.size(); }
  // When the base has a value: at which of its stages.
  int base_level(const RoleComponent& value) const;
  // Whether what limbs hand on to a segment's bodies (−1: to the base) is added to what is kept of the role itself.
  bool adds_to_own(int segment, const RoleComponent& value) const;
};

// The paragraphs of every segment.
void roll_segments(RollState& state);
// Drops what nobody reads, and says what segments hand on.
void prune(RollState& state);
// The base's stages: what the segments and the results read of it.
void roll_base(RollState& state);
// Matrices of pairs: which are filled together, and between which limbs their blocks are.
void roll_pairs(RollState& state);
// Projections: the bodies whose columns lanes give, and the base's rows.
void roll_projections(RollState& state);
// Which roles of joints go to which elements of results.
void roll_results(RollState& state);
// Gives values their places.
void place(RollState& state);
// Which results need not be copied from there.
void leave_in_slots(RollState& state);

}  // namespace dalembert::passes
