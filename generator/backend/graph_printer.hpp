// Prints the needed part of a scalar graph as C++ statements, one per named or shared value.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "ir/graph.hpp"
#include "ir/scene.hpp"

namespace dalembert::backend {

// What to do with a value once it is there: `target = value;` is printed as "<before><value><after>".
struct Sink {
  ir::NodeId node = ir::no_node;
  std::string before, after;
  bool carried = false;  // to the next step of the loop, which reads it as an input of kind carried
};

struct PrintStyle {
  std::string type;  // of the variables: "Scalar", "V"
  ir::ScalarType scalar = ir::ScalarType::float64;
  std::string indent = "  ";
  // Sums of sums written as one sum, plain terms first: every product is then one multiply-add. Fewer operations, one longer
  // chain of them: pays in lanes, where throughput is the limit, and costs a few percent in straight scalar code. In a loop
  // whose steps wait for each other long chains are two.
  bool flat_sums = false;
  std::function<std::string(const std::string&)> broadcast;  // if set: a value of that type from a number, which is none
  std::function<std::string(const ir::Input&)> input;        // text of an input
  std::function<std::string(const ir::Input&)> input_name;   // if set: inputs used twice are read once, into this variable
  std::function<bool(const ir::Input&)> held;                // if set: inputs that are read so even where they are used once
  std::function<std::string(ir::NodeId)> name;               // wanted name of a node, or empty
  std::function<std::string(const ir::Tag&)> heading;        // comment lines before a paragraph, or empty
  std::function<std::string(const ir::Tag&)> return_to;      // if set: instead of it where a paragraph is taken up again
  std::vector<ir::NodeId> order;                             // of the nodes; empty: that of their numbers
  std::function<std::string(const ir::Graph&, ir::NodeId)> sine_or_cosine;  // text of an Op::sine or Op::cosine
};

// Statements in the order of the nodes. Values used once are written where they are used, as long as the expression stays
// readable; each sink follows as soon as its value is known. Constant sinks come first.
std::string print(const ir::Graph& graph, const std::vector<Sink>& sinks, const PrintStyle& style);

}  // namespace dalembert::backend
