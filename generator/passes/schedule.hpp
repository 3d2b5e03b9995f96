// The order in which a straight line computes its values.
//
// Neither order has fewer operations. What differs is how long values wait in registers, and for how many of them there is
// room: of sixteen registers a robot's hundred live values overflow whatever is done, and each that does costs a store and a
// load.
#pragma once

#include <vector>

#include "ir/compile_options.hpp"
#include "ir/graph.hpp"

namespace dalembert::passes {

// What the roots need, operands before what is made of them. A statement's own values, those that nothing else reads, stand
// together in the order of the graph. The same graph gives the same order anywhere.
std::vector<ir::NodeId> schedule(const ir::Graph& graph, const std::vector<ir::NodeId>& roots, ir::Order order);

}  // namespace dalembert::passes
