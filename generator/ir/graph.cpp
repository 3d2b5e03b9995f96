#include "ir/graph.hpp"

#include <algorithm>
#include <bit>
#include <set>
#include <utility>

namespace dalembert::ir {

namespace {

// What makes two nodes equal, in two words.
struct Key {
  std::uint64_t head, tail;
  bool operator==(const Key&) const = default;
};

std::uint64_t pair(std::int32_t a, std::int32_t b) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32 | static_cast<std::uint32_t>(b);
}

Key key_of(const Node& n) {
  const auto op = static_cast<std::uint64_t>(n.op);
  if (n.op == Op::constant) return {op, std::bit_cast<std::uint64_t>(n.value)};
  if (n.op == Op::input)
    return {op | static_cast<std::uint64_t>(n.input.kind) << 8 |
                static_cast<std::uint64_t>(static_cast<std::uint32_t>(n.input.body)) << 16,
            pair(n.input.index, n.input.component)};
  return {op, pair(n.a, n.b)};
}

std::size_t hash(const Key& k) {
  std::uint64_t x = (k.tail ^ k.head * 0xC2B2AE3D27D4EB4Full) * 0x9E3779B97F4A7C15ull;
  x ^= x >> 32;
  return static_cast<std::size_t>(x * 0xD6E8FEB86659FD93ull >> 16);
}

}  // namespace

std::size_t Graph::place_of(const Node& node, const Table& table) const {
  const Key key = key_of(node);
  const std::size_t mask = table.places.size() - 1;
  std::size_t at = hash(key) & mask;
  while (table.places[at] != no_node && !(key_of((*this)[table.places[at]]) == key)) at = (at + 1) & mask;
  return at;
}

void Graph::reserve(std::size_t nodes) {
  nodes_.reserve(nodes);
  if (2 * nodes > table_.places.size()) resize(table_, std::bit_ceil(2 * nodes));
}

void Graph::resize(Table& table, std::size_t places) {
  std::vector<NodeId> old(places, no_node);
  old.swap(table.places);
  for (NodeId id : old)
    if (id != no_node) table.places[place_of((*this)[id], table)] = id;
}

void Graph::open_scope(const std::vector<NodeId>& own, const std::vector<NodeId>& readers) {
  scope_ = size();
  own_.assign(static_cast<std::size_t>(scope_), false);
  for (const NodeId id : own) own_[static_cast<std::size_t>(id)] = true;
  for (const NodeId id : readers)
    if (is_entry((*this)[id])) enter(id, table_of_scope_);
}

void Graph::close_scope() {
  nodes_.resize(static_cast<std::size_t>(scope_));
  std::fill(table_of_scope_.places.begin(), table_of_scope_.places.end(), no_node);
  table_of_scope_.entries = 0;
  scope_ = no_node;
}

void Graph::enter(NodeId id, Table& table) {
  NodeId& place = table.places[place_of((*this)[id], table)];
  if (place != no_node) return;
  place = id;
  if (2 * ++table.entries > table.places.size()) resize(table, 2 * table.places.size());
}

NodeId Graph::intern(Node node) {
  node.tag = tag_;
  if (!is_entry(node)) {
    nodes_.push_back(node);
    return size() - 1;
  }
  if (const NodeId found = find(node); found != no_node) {
    if (found >= retagged_) nodes_[static_cast<std::size_t>(found)].tag = tag_;
    return found;
  }
  nodes_.push_back(node);
  enter(size() - 1, scope_ == no_node ? table_ : table_of_scope_);
  return size() - 1;
}

NodeId Graph::find(const Node& node) const {
  if (scope_ != no_node) {
    const NodeId found = table_of_scope_.places[place_of(node, table_of_scope_)];
    if (found != no_node || of_scope(node.a) || of_scope(node.b)) return found;
  }
  return table_.places[place_of(node, table_)];
}

NodeId Graph::constant(double value) {
  if (value == 0) value = 0;  // one zero: −0 would not compare equal as a key
  return intern({Op::constant, no_node, no_node, value, {}, {}});
}

NodeId Graph::input(Input input) { return intern({Op::input, no_node, no_node, 0, input, {}}); }

NodeId Graph::unary(Op op, NodeId a) { return intern({op, a, no_node, 0, {}, {}}); }

NodeId Graph::sign(NodeId a) {
  if (const double value = (*this)[a].value; options_.fold && is_constant(a))
    return constant(value > 0 ? 1 : value < 0 ? -1 : 0);
  return unary(Op::sign, a);
}

NodeId Graph::negate(NodeId a) {
  const Node n = (*this)[a];
  if (n.op == Op::constant) return constant(-n.value);
  if (n.op == Op::negate) return n.a;
  if (n.op == Op::subtract) return subtract(n.b, n.a);
  return unary(Op::negate, a);
}

NodeId Graph::add(NodeId a, NodeId b) {
  if (options_.fold) {
    if (is_constant(a) && is_constant(b)) return constant((*this)[a].value + (*this)[b].value);
    if (is_constant(a, 0)) return b;
    if (is_constant(b, 0)) return a;
    if (is_constant(b)) std::swap(a, b);
    if (const Node n = (*this)[b]; is_constant(a) && n.op == Op::add && is_constant(n.a))  // constants of a sum are one
      return add(constant((*this)[a].value + (*this)[n.a].value), n.b);
    else if (is_constant(a) && n.op == Op::add && is_constant(n.b))
      return add(constant((*this)[a].value + (*this)[n.b].value), n.a);
  }
  const bool na = (*this)[a].op == Op::negate, nb = (*this)[b].op == Op::negate;
  if (na && nb) return negate(add((*this)[a].a, (*this)[b].a));
  if (nb) return subtract(a, (*this)[b].a);
  if (na) return subtract(b, (*this)[a].a);
  if (a > b) std::swap(a, b);
  return intern({Op::add, a, b, 0, {}, {}});
}

NodeId Graph::subtract(NodeId a, NodeId b) {
  if (options_.fold) {
    if (is_constant(a) && is_constant(b)) return constant((*this)[a].value - (*this)[b].value);
    if (is_constant(a, 0)) return negate(b);
    if (is_constant(b, 0)) return a;
    if (a == b) return constant(0);
  }
  if ((*this)[b].op == Op::negate) return add(a, (*this)[b].a);
  if ((*this)[a].op == Op::negate) return negate(add((*this)[a].a, b));
  if (options_.share)
    if (const NodeId reverse = find({Op::subtract, b, a, 0, {}, {}}); reverse != no_node) return unary(Op::negate, reverse);
  return intern({Op::subtract, a, b, 0, {}, {}});
}

NodeId Graph::multiply(NodeId a, NodeId b) {
  if (is_constant(b)) std::swap(a, b);  // a constant stands first
  if (options_.fold && is_constant(a)) {
    const double value = (*this)[a].value;
    if (is_constant(b)) return constant(value * (*this)[b].value);
    if (value == 0) return a;
    if (value == 1) return b;
    if (value == -1) return negate(b);
  }
  const bool na = (*this)[a].op == Op::negate, nb = (*this)[b].op == Op::negate;
  if (na && nb) return multiply((*this)[a].a, (*this)[b].a);
  if (na) return negate(multiply((*this)[a].a, b));
  if (nb) return negate(multiply(a, (*this)[b].a));
  if (options_.fold && is_constant(a) && (*this)[a].value < 0) return negate(multiply(constant(-(*this)[a].value), b));
  if (!is_constant(a) && a > b) std::swap(a, b);
  return intern({Op::multiply, a, b, 0, {}, {}});
}

NodeId Graph::divide(NodeId a, NodeId b) {
  if (options_.fold && is_constant(b, 1)) return a;
  if (options_.fold && is_constant(a) && is_constant(b) && (*this)[b].value != 0)
    return constant((*this)[a].value / (*this)[b].value);
  return intern({Op::divide, a, b, 0, {}, {}});
}

NodeId Graph::where(NodeId a, NodeId b) {
  if (options_.fold && is_constant(a)) return (*this)[a].value > 0 ? b : constant(0);
  if (options_.fold && is_constant(b, 0)) return b;
  return intern({Op::where, a, b, 0, {}, {}});
}

NodeId Graph::make(Op op, NodeId a, NodeId b, double value) {
  switch (op) {
    case Op::constant: return constant(value);
    case Op::input: break;
    case Op::sine: return sine(a);
    case Op::cosine: return cosine(a);
    case Op::sign: return sign(a);
    case Op::negate: return negate(a);
    case Op::add: return add(a, b);
    case Op::subtract: return subtract(a, b);
    case Op::multiply: return multiply(a, b);
    case Op::divide: return divide(a, b);
    case Op::where: return where(a, b);
  }
  return no_node;
}

namespace {
std::vector<std::int32_t> uses_but(const Graph& graph, const std::vector<NodeId>& roots, bool by_sines) {
  std::vector<std::int32_t> count(static_cast<std::size_t>(graph.size()), 0);
  for (NodeId root : roots) ++count[static_cast<std::size_t>(root)];
  for (NodeId id = graph.size() - 1; id >= 0; --id) {
    const Node& n = graph[id];
    if (count[static_cast<std::size_t>(id)] == 0 || (!by_sines && (n.op == Op::sine || n.op == Op::cosine))) continue;
    if (n.a != no_node) ++count[static_cast<std::size_t>(n.a)];
    if (n.b != no_node) ++count[static_cast<std::size_t>(n.b)];
  }
  return count;
}
}  // namespace

std::vector<std::int32_t> uses(const Graph& graph, const std::vector<NodeId>& roots) { return uses_but(graph, roots, true); }
std::vector<std::int32_t> uses_in_text(const Graph& graph, const std::vector<NodeId>& roots) {
  return uses_but(graph, roots, false);
}

Operations count(const Graph& graph, const std::vector<std::int32_t>& uses) {
  Operations total;
  std::set<NodeId> angles;
  for (NodeId id = 0; id < graph.size(); ++id) {
    if (uses[static_cast<std::size_t>(id)] == 0) continue;
    const Node& n = graph[id];
    total.count(n.op);
    if (n.op == Op::sine || n.op == Op::cosine) angles.insert(n.a);
  }
  total.sincos = static_cast<long>(angles.size());
  return total;
}

}  // namespace dalembert::ir
