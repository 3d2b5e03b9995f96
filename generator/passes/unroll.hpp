// Unrolling: an algorithm on one tree as a single scalar program.
//
// Every sweep's graph is copied for every body, with parameters replaced by constants, and roles by the nodes they are; the
// graph folds and shares as it is made, so the robot's zeros and ones disappear. What no result needs is not copied
// (passes/live.hpp).
//
// What grows with the square of a robot are the elements of its matrices. A program that nobody writes out need not hold them:
// column by column, a body with all that is above it, they are made, counted and forgotten. The counts are those of the program
// that has them all, for two columns share no operation on a factor that only one of them has; what has none such is kept.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "ir/algorithm.hpp"
#include "ir/implicit_joints.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/normal_tree.hpp"
#include "ir/program.hpp"
#include "ir/scene.hpp"
#include "passes/live.hpp"

namespace dalembert::passes {

struct UnrollOptions {
  ir::Graph::Options graph{};
  bool names = true;      // keep names for reading
  bool implicit = false;  // dampers and springs as a linearly implicit step has them (ir/implicit_joints.hpp)
  ir::Elements elements = ir::Elements::kept;
  std::vector<int> references{};  // bodies whose frames their branches have for theirs; else the first body's, or the base's
};

class Unroll {
 public:
  // References all but the options.
  Unroll(const ir::Algorithm& algorithm, const ir::KinematicTree& tree, const ir::NormalTree& normal, const ir::Scene& scene,
         const UnrollOptions& options = {});

  // The program of all results, or, where elements are counted, of all others. Elements that are zero for every state are left
  // out; they stand in the order of arrays and, within one, column by column.
  const ir::Program& program() const { return program_; }
  ir::Program take_program() { return std::move(program_); }

  // The node of a role of a body (−1: the base); no_node where nothing needed it.
  ir::NodeId role(int role, int component, int body) const { return values_[index(place(body, -1), role, component)]; }
  // Of a coordinate of the base.
  ir::NodeId coordinate_role(int role, int component, int coordinate) const {
    return values_[index(place(-1, coordinate), role, component)];
  }
  // The same, or the joint's coordinate where the role is one.
  ir::NodeId kept(int role, int component, int body);
  ir::NodeId input_node(const ir::Input& input) { return program_.graph.input(input); }
  // What the children of the body hand on, summed; no_node where they hand nothing on.
  ir::NodeId handed(int role, int component, int body) const { return handed_[index(place(body, -1), role, component)]; }
  ir::NodeId parameter(int parameter, int body);
  ir::NodeId plain_parameter(int parameter, int body);  // without what is known at run time
  // What the scene's payloads or a joint's quaternion add to it; no_node: nothing.
  ir::NodeId added_parameter(int parameter, int body) const;

  const Live& live() const { return live_; }

 private:
  struct Loop {
    std::vector<int> sweeps;  // of one direction; none: pairs alone
    std::vector<int> pairs;   // after the sweeps, body by body
  };

  std::size_t place(int body, int coordinate) const {
    return static_cast<std::size_t>(coordinate < 0 ? body + 1 : static_cast<int>(tree_.bodies.size()) + 1 + coordinate);
  }
  std::size_t index(std::size_t place, int role, int component) const {
    return place * static_cast<std::size_t>(live_.offset.back()) + live_.at(role, component);
  }
  std::vector<Loop> loops() const;
  std::vector<Loop> joined(std::vector<Loop> loops) const;
  int last_inwards(int role, std::vector<int>& known) const;
  void run_loop(const Loop& loop);
  void reserve_elements();
  void add_implicit_joints();
  ir::NodeId implicit_effort(ir::NodeId effort, int body);
  void find_companions();
  void run_sweep(int sweep, int body);
  void refer_to(int body);
  void place_from_below(int sweep, int body);
  void run_pairs(int pairs, int body);
  void run_projection(int projection, int body);
  void count_elements();
  long operations_from(int first_tag) const;
  void claim_factors();
  void claim(ir::NodeId factor, int body);
  void count_column(int body);
  bool is_known(int filling, int body, int above);
  ir::NodeId factor(std::size_t place, int role, int component);
  ir::NodeId dot(const std::vector<ir::PairTerm>& terms, std::size_t lower, std::size_t upper);
  ir::NodeId value(int role, int component, int body, int coordinate = -1);
  ir::NodeId input(const ir::Sweep& sweep, const ir::Input& input, int body);
  void collect_results();
  void put(int array, int row, int column, ir::NodeId node);
  // Of what fills a matrix: pairs and, behind them, projections.
  ir::Tag tag_of(int filling, int body) const {
    return {static_cast<std::int16_t>(static_cast<int>(algorithm_.sweeps.size()) + filling), body};
  }
  int row_of(int body) const { return base_rows_ + coordinates_[static_cast<std::size_t>(body)]; }
  void name(ir::NodeId node, const ir::Role& role, int component, int body);

  const ir::Algorithm& algorithm_;
  const ir::KinematicTree& tree_;
  const ir::NormalTree& normal_;
  const ir::Scene& scene_;
  const UnrollOptions options_;
  const Live live_;
  const std::vector<int> coordinates_, positions_, links_;
  const int base_rows_;
  const std::vector<ir::ImplicitJoint> implicit_;
  std::vector<int> producer_;                       // per role: the sweep that stores it for bodies, −1: none
  std::vector<int> base_producer_;                  // … for the base alone or its coordinates
  std::vector<std::map<int, ir::NodeId>> payload_;  // per body + 1
  std::vector<std::vector<int>> companions_;        // per sweep outwards: those anywhere that run beside it, body by body
  std::vector<int> towards_;        // per body above the one whose frame is that of reference the next to it; that one: itself
  std::vector<bool> at_its_joint_;  // per body: its moments count at its joint's axis
  std::vector<ir::NodeId> values_, handed_;
  std::vector<std::vector<bool>> done_;                       // per sweep and body + 1
  std::map<std::tuple<int, int, int>, ir::NodeId> elements_;  // array, column, row
  // Where elements are counted, which all are but for those that parts of a quaternion's joint add to each other's:
  bool counts_elements() const;
  std::vector<int> filled_;                               // arrays: by pairs and, behind them, by projections; a bit each
  std::vector<std::vector<bool>> known_;                  // by these, per body: whether one below has met it
  std::vector<std::vector<ir::NodeId>> turns_;            // per pairs and body + 1: nodes there were behind its turn
  std::vector<int> owner_;                                // per node: the only body in whose column it is a factor
  std::vector<std::vector<ir::NodeId>> own_, readers_;    // per body: these nodes, and those that read them
  enum class Column { none, met, counted } column_is_{};  // what is done with elements that are put
  bool each_alone_ = false;                               // no two bodies have a coordinate together
  std::vector<std::pair<int, ir::NodeId>> column_;        // its elements' arrays and nodes
  std::vector<std::tuple<int, int, int>> sums_;           // where not each is alone: its elements among all
  std::vector<std::uint64_t> needed_by_;                  // per node: arrays whose counted elements need it
  std::map<std::uint64_t, ir::Operations> counted_;       // by the arrays that need them
  ir::Program program_;
  ir::Tag tag_;
};

}  // namespace dalembert::passes
