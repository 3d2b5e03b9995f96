// Runs a scalar program on numbers: what the emitted code must compute, without emitting it.
#pragma once

#include <cmath>
#include <vector>

#include "ir/program.hpp"

namespace dalembert::ir {

// Values of every node. `input` maps an Input to a Scalar; it is called for every input node, needed or not.
template <class Scalar, class InputValue>
std::vector<Scalar> interpret(const Graph& graph, const InputValue& input) {
  std::vector<Scalar> value(static_cast<std::size_t>(graph.size()));
  for (NodeId id = 0; id < graph.size(); ++id) {
    using std::cos;
    using std::sin;
    const Node& n = graph[id];
    const auto at = [&](NodeId operand) -> const Scalar& { return value[static_cast<std::size_t>(operand)]; };
    Scalar& v = value[static_cast<std::size_t>(id)];
    switch (n.op) {
      case Op::constant: v = Scalar(n.value); break;
      case Op::input: v = input(n.input); break;
      case Op::sine: v = sin(at(n.a)); break;
      case Op::cosine: v = cos(at(n.a)); break;
      case Op::sign: v = Scalar((at(n.a) > Scalar(0)) - (at(n.a) < Scalar(0))); break;
      case Op::negate: v = -at(n.a); break;
      case Op::add: v = at(n.a) + at(n.b); break;
      case Op::subtract: v = at(n.a) - at(n.b); break;
      case Op::multiply: v = at(n.a) * at(n.b); break;
      case Op::divide: v = at(n.a) / at(n.b); break;
    }
  }
  return value;
}

}  // namespace dalembert::ir
