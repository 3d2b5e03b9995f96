// A robot's dynamics as one scalar program: which node goes to which element of which result.
#pragma once

#include <map>
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

// Whether a program has the elements of matrices that a body fills with all that is above it, or has counted and forgotten
// them: as many as bodies in a chain squared (passes/unroll.hpp).
enum class Elements { kept, counted };

struct CountedElements {
  // Operations that these arrays need, and no other.
  struct Share {
    std::set<int> arrays;
    Operations operations;
  };
  std::vector<Share> shares;
  std::map<int, std::vector<NodeId>> factors;  // per array: the nodes of the graph that they were made of
  long nodes = 0;                              // forgotten
};

struct Program {
  Graph graph;
  int base_positions = 0;  // positions below this index are the base's
  std::vector<OutputArray> arrays;
  std::vector<OutputElement> elements;  // structural zeros are not listed
  std::vector<std::string> names;       // per node: a name for reading, empty where there is none
  std::vector<NodeId> order;            // in which the nodes needed are computed; empty: that of their numbers
  CountedElements counted{};            // instead of elements

  // What all arrays need of the graph, or some.
  std::vector<NodeId> roots() const {
    return roots_of([](int) { return true; });
  }
  std::vector<NodeId> roots(const std::set<int>& of_arrays) const {
    return roots_of([&](int array) { return of_arrays.contains(array); });
  }

 private:
  template <class Wanted>
  std::vector<NodeId> roots_of(const Wanted& wanted) const {
    std::vector<NodeId> ids;
    for (const OutputElement& e : elements)
      if (wanted(e.array)) ids.push_back(e.node);
    for (const auto& [array, factors] : counted.factors)
      if (wanted(array)) ids.insert(ids.end(), factors.begin(), factors.end());
    return ids;
  }
};

// Of one evaluation: of all arrays; and what was counted and forgotten of some.
Operations operations(const Program& program);
Operations counted(const Program& program, const std::set<int>& of_arrays);

// Which inputs the nodes used (see uses()) depend on.
struct InputsRead {
  std::set<int> positions;   // indices into q
  std::set<int> velocities;  // indices into v
  bool input = false;        // what the function takes besides q and v
  int base_positions = 0;    // as in Program

  void add(const Input& in);
  bool base_pose() const { return !positions.empty() && *positions.begin() < base_positions; }
  bool base_position() const { return base_pose() && *positions.begin() < 3; }  // not the orientation alone
  bool joint_positions() const { return !positions.empty() && *positions.rbegin() >= base_positions; }
};
InputsRead inputs_read(const Program& program, const std::vector<std::int32_t>& uses);

}  // namespace dalembert::ir
