#include "ir/algorithm.hpp"

#include <algorithm>

namespace dalembert::ir {

int components(Shape shape) {
  switch (shape) {
    case Shape::scalar: return 1;
    case Shape::vector: return 3;
    case Shape::symmetric:
    case Shape::wrench: return 6;
    case Shape::matrix: return 9;
  }
  return 0;
}

std::string component_suffix(Shape shape, int component) {
  constexpr const char* symmetric[] = {"xx", "xy", "xz", "yy", "yz", "zz"};
  constexpr const char* wrench[] = {"vx", "vy", "vz", "wx", "wy", "wz"};
  const auto at = static_cast<std::size_t>(component);
  switch (shape) {
    case Shape::scalar: return "";
    case Shape::vector: return std::string(1, "xyz"[at]);
    case Shape::symmetric: return symmetric[at];
    case Shape::wrench: return wrench[at];
    case Shape::matrix: return {"xyz"[at / 3], "xyz"[at % 3]};
  }
  return "";
}

std::vector<Input> Projection::inputs(InputKind kind) const {
  const std::vector<std::int32_t> used = uses(graph, columns);
  std::vector<Input> found;
  for (NodeId id = 0; id < graph.size(); ++id)
    if (const Node& n = graph[id]; used[static_cast<std::size_t>(id)] > 0 && n.op == Op::input && n.input.kind == kind)
      found.push_back(n.input);
  return found;
}

bool Section::computes(Quantity quantity) const {
  return std::find(quantities.begin(), quantities.end(), quantity) != quantities.end();
}

const std::string& Algorithm::equation(const Tag& tag) const {
  auto at = static_cast<std::size_t>(tag.sweep);
  if (at < sweeps.size()) return sweeps[at].equation;
  at -= sweeps.size();
  if (at < pairs.size()) return pairs[at].equation;
  at -= pairs.size();
  return at < projections.size() ? projections[at].equation : written_out[at - projections.size()];
}

std::vector<int> Algorithm::offsets() const {
  std::vector<int> first;
  int next = 0;
  for (const Role& role : roles) {
    first.push_back(next);
    next += role.components();
  }
  first.push_back(next);
  return first;
}

}  // namespace dalembert::ir
