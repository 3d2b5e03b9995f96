// The rolled form: paragraphs of scalar program that are run over the slots of a segment, in lanes, with tables of constants.
#pragma once

#include <string>
#include <vector>

#include "ir/graph.hpp"

namespace dalembert::ir {

// A value kept per slot between paragraphs, `components` numbers of it.
struct Role {
  std::string name;
  std::string meaning;
  int components = 0;
  int place = -1;  // the role in whose array it is kept; -1: in its own
};

// A column of constants of one segment: one value per slot.
struct Column {
  std::string name;
  std::vector<double> values;
};

enum class Direction {
  outwards,  // step by step from the root, carrying values along; lanes are limbs
  inwards,   // step by step towards the root; what is carried over the last step is added to the parents' slots
  anywhere,  // slots in any order, as many at once as the target's registers hold
};

struct StateStore {
  int role = 0;
  int component = 0;
  NodeId node = no_node;
};

// One phase of the bodies of one segment.
struct Paragraph {
  std::string name;                    // "kinematics"
  std::vector<std::string> equations;  // what it computes, for reading
  Direction direction = Direction::anywhere;
  Graph graph;
  std::vector<StateStore> stores;   // to this slot
  std::vector<StateStore> carried;  // to the next step (outwards: values of this body; inwards: in the parent's terms)
};

// A component of a role.
struct StateValue {
  int role = 0;
  int component = 0;
  bool operator==(const StateValue&) const = default;
};

struct SegmentCode {
  std::vector<Column> columns;
  std::vector<Paragraph> paragraphs;  // in the order of Stage
  std::vector<int> parents;           // segments that hold its first bodies' parents, -1: the root
  // Sums whose own share is a constant of the body: no paragraph stores it, whoever reads the sum adds it from the table. Kept
  // is what attached limbs bring: the first to arrive assigns, later ones add; slots without limbs stay zero.
  std::vector<StateValue> received;
};

// The values at the root and what depends on them alone, without lanes.
struct RootCode {
  Graph graph;
  std::vector<StateStore> stores;  // to the root's slot
};

struct BlockElement {
  int array = 0, row = 0, column = 0;
  NodeId node = no_node;
};

struct RolledProgram {
  std::vector<Role> roles;            // empty name: unused
  std::vector<SegmentCode> segments;  // parallel to Plan::segments
  RootCode root;                      // before the segments
  Graph base_graph;                   // after them: the base's own block and rows
  std::vector<BlockElement> base_elements;
  bool mass = false, coriolis = false, gravity = false, bias = false, wrench = false;
  bool all_revolute = true;
};

}  // namespace dalembert::ir
