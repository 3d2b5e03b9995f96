// A robot's dynamics as one scalar program: which node goes to which element of which result.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "ir/algorithm.hpp"

namespace dalembert::ir {

struct OutputElement {
  int array = 0;  // index into Program::arrays
  int row = 0;
  int column = 0;
  NodeId node = no_node;
};

struct Program {
  Graph graph;
  int base_positions = 0;  // positions below this index are the base's
  std::vector<OutputArray> arrays;
  std::vector<OutputElement> elements;  // structural zeros are not listed
  std::vector<std::string> names;       // per node: a name for reading, empty where there is none
  std::vector<NodeId> order;            // in which the nodes needed are computed; empty: that of their numbers

  std::vector<NodeId> roots() const {
    std::vector<NodeId> ids;
    for (const OutputElement& e : elements) ids.push_back(e.node);
    return ids;
  }
};

// Which inputs the nodes used (see uses()) depend on.
struct InputsRead {
  std::set<int> positions;   // indices into q
  std::set<int> velocities;  // indices into v
  bool input = false;        // what the function takes besides q and v
  bool constraints = false;  // how contacts and loops hold
  int base_positions = 0;    // as in Program

  bool base_pose() const { return !positions.empty() && *positions.begin() < base_positions; }
  bool base_position() const { return base_pose() && *positions.begin() < 3; }  // not the orientation alone
  bool joint_positions() const { return !positions.empty() && *positions.rbegin() >= base_positions; }
};
InputsRead inputs_read(const Program& program, const std::vector<std::int32_t>& uses);

}  // namespace dalembert::ir
