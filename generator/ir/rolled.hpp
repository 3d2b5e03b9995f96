// The rolled form: paragraphs of scalar program that run over the slots of a segment, in lanes, with tables of constants.
//
// Every body has a slot, and so has the base. A value that one stage leaves for another is kept there.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "ir/algorithm.hpp"
#include "ir/pair_blocks.hpp"

namespace dalembert::ir {

// A number that is kept: a component of a role, at the slot of a body (−1: the base), or in a loop at its own slot.
struct Address {
  static constexpr int own = -2;      // body
  static constexpr int unknown = -1;  // role: place() has not said it yet, or nothing needs it
  int role = 0, component = 0, body = own;
  bool operator==(const Address&) const = default;

  Input input() const { return {InputKind::kept, role, component, body}; }
};
inline Address address(const Input& in) { return {in.index, in.component, in.body}; }

struct Store {
  Address to;
  NodeId node = no_node;
};

// Where a role is kept: from a component of an array on. Roles whose values are not needed at the same time, or are the same,
// share an array.
struct Place {
  int array = -1;  // −1: nowhere
  int from = 0;
};
struct KeptArray {
  std::string name, meaning;
  int components = 0;
  bool operator==(const KeptArray&) const = default;
};

// A column of constants of one segment: one value per slot. Constants that are equal at every body share one, and all their
// names.
struct Column {
  std::vector<std::string> names;
  std::string unit;
  std::vector<double> values;

  void add_name(const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
};

// What a step of a loop takes over from the one before, and where the first step has it from.
struct Carried {
  int role = 0, component = 0;
  NodeId node = no_node;                       // outwards: this body's value; inwards: what it hands on
  std::vector<std::optional<double>> initial;  // outwards, per lane: the parent's value where it is constant
  std::vector<Address> from{};                 // outwards, unless known: the parents', per lane, or one that all lanes have

  // Whether all lanes begin with constants; else the parents' values are kept.
  bool known() const {
    return std::all_of(initial.begin(), initial.end(), [](const std::optional<double>& x) { return x.has_value(); });
  }
};

// What one step of a loop does that is written out, step after step. Inputs: `carried` from the step before, `kept`, and, of
// limbs side by side, `table` where their constants differ.
struct LimbStep {
  int place = 0;  // among the segment's steps
  int body = 0;   // of the first lane that is read
  Graph graph;
  std::vector<Store> stores;     // to the slots of the step; of a limb that stands alone, to the body's
  std::vector<Carried> carried;  // to the next step, which reads it, or, of the last inwards, to whoever it hangs on

  std::vector<NodeId> roots() const;  // all of them
};

// How a loop goes over the slots of its segment.
struct SlotLoop {
  enum class Lanes {
    along,     // slots in any order, as many at a time as a register holds
    by_fours,  // likewise, but four at most
    all,       // step by step, all lanes of a step at a time
    in_parts,  // step by step for as many limbs as share a register, and again for the next
  };
  Direction direction = Direction::anywhere;
  Lanes lanes = Lanes::along;
  int first_slot = 0, steps = 0, width = 1, limbs = 1;  // as of ir::Segment

  bool by_steps() const { return lanes == Lanes::all || lanes == Lanes::in_parts; }
  bool in_parts() const { return lanes == Lanes::in_parts; }
  int slots() const { return steps * width; }
  // The step that is taken as number i.
  int step(int i) const { return direction == Direction::inwards ? steps - 1 - i : i; }
  // Where registers hold so many numbers: how many steps or registers come one after another, and registers of each step.
  int trips(int register_lanes) const { return by_steps() ? steps : registers(slots(), register_lanes); }
  int side_by_side(int register_lanes) const { return by_steps() ? registers(limbs, register_lanes) : 1; }
  // Numbers that are computed of each value; of what is left over of a step in a smaller register.
  int computed(int register_lanes) const;

 private:
  static int registers(int count, int lanes) { return (count + lanes - 1) / lanes; }
};

// What the loop hands on to a body: summed over the lanes that hang on it.
struct HandedOn {
  int role = 0, component = 0;  // carried
  Address to;  // where it is added: to what is kept of the role already, or to a role of its own, which place() makes
  std::vector<int> lanes;
  bool first = false;  // the first to come: it sets the number instead of adding to it
};

// Some sweeps on the bodies of one segment. Inputs, once roles have their places: `carried`, `table`, `kept`.
struct Paragraph {
  std::vector<std::string> equations;
  SlotLoop loop;
  Graph graph;
  std::vector<Store> stores;  // to this slot
  std::vector<Carried> carried;
  std::vector<HandedOn> handed{};   // inwards, behind the last step
  std::vector<int> live_lanes{};    // whose numbers anybody reads
  std::vector<LimbStep> written{};  // in the order in which they run; none: it is a loop

  std::vector<NodeId> roots() const;  // of the loop
};

// The paragraphs of one level of one segment.
struct SegmentStage {
  int level = 0;
  std::vector<Paragraph> paragraphs;
};

struct SegmentCode {
  std::vector<Column> columns;
  std::vector<SegmentStage> stages;
};

struct BlockElement {
  int array = 0, row = 0, column = 0;
  NodeId node = no_node;
};

// The base at one level, without lanes. Level 0 comes before all segments. Inputs: the function's, `kept`.
struct BaseStage {
  int level = 0;
  std::vector<std::string> equations;
  Graph graph;
  std::vector<Store> stores;  // to the base's slot, or to bodies': what payloads add to these
  std::vector<BlockElement> elements;
  bool checks_pivots = false;  // of limbs: behind the base's own, where one operation waits for another, and there is time

  std::vector<NodeId> roots() const;
};

// A matrix of pairs between joints; the base's rows and columns are kept per joint.
struct RolledPairs {
  int columns = -1;  // role, six components: elements (0…5, k); −1: the base has none
  int rows = -1;     // role, six components: elements (k, 0…5)
};

// A projection: lanes run along the rows of joints, and the base's rows, whose coordinates are constants, are what that leaves
// of its graph.
struct RolledProjection {
  std::vector<ProjectedBody> bodies;
  Graph graph;                     // inputs of kind state: roles of the body
  std::vector<BlockElement> base;  // columns count from the body's first

  std::vector<NodeId> roots() const;
};

// A role of joints that is a result: which elements are which joints' numbers.
struct JointResult {
  struct Element {
    int at = 0;  // in the array, column by column
    Address from;
    bool first = false;  // the first to come: others are added to it, as of joints that follow one
  };
  int result = 0;      // of the algorithm
  bool whole = false;  // every joint's number in its place: a loop over joints
  std::vector<Element> elements;
  bool copied = true;  // else it is read where limbs leave it
};

// What nothing reads but the check whether M can be solved with and rows of constraints that go up limbs: roles of joints,
// which they read in their slots. −1: not asked for.
struct PivotRoles {
  int pivot = -1, diagonal = -1;             // of M
  int gain = -1, linear = -1, angular = -1;  // V, J
};
// Likewise joints' axes, for what constraints bear.
struct AxesRoles {
  int linear = -1, angular = -1;
};

// A constant added to an element: armature; or that much of a body's role.
struct AddedConstant {
  int array = 0, row = 0, column = 0;
  double value = 0;
  int role = -1, body = 0;
};

struct RolledProgram {
  std::vector<Role> roles;    // the algorithm's, then those that the rolled form adds
  std::vector<Place> places;  // per role
  std::vector<KeptArray> arrays;
  std::vector<SegmentCode> segments;  // parallel to Plan::segments
  std::vector<BaseStage> base;
  std::vector<RolledPairs> pairs;             // parallel to Algorithm::pairs
  std::vector<PairBlocks> blocks;             // which fill them
  std::vector<RolledProjection> projections;  // parallel to Algorithm::projections
  std::vector<JointResult> results;
  std::optional<PivotRoles> pivots_in_slots;
  std::optional<AxesRoles> axes_in_slots;
  std::vector<AddedConstant> added;

  bool is_kept(int role) const { return places.at(static_cast<std::size_t>(role)).array >= 0; }
  // One more than the highest of any stage; at least one.
  int levels() const;
};

}  // namespace dalembert::ir
