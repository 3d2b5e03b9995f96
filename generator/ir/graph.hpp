// The scalar program: a hash-consed graph of scalar operations.
//
// Equal nodes are one node; constants fold and signs move outwards as nodes are made, so zeros and ones of the robot disappear
// where they arise and common subexpressions are shared without a pass of their own. A node's operands always have smaller
// numbers than the node: the order of creation is an order of evaluation.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace dalembert::ir {

using NodeId = std::int32_t;
inline constexpr NodeId no_node = -1;

enum class Op : std::uint8_t { constant, input, sine, cosine, sign, negate, add, subtract, multiply, divide, where };

// Where a value enters. `index` and `component` say which one, in the terms of `kind`.
enum class InputKind : std::uint8_t {
  position,      // index: position in q
  velocity,      // index: position in v
  acceleration,  // index: position in dv/dt, as inverse dynamics takes it
  effort,        // index: position in tau, as forward dynamics takes it
  gravity,       // component 0…2 of the gravity vector given at run time
  wrench,        // index: number of an external wrench; component: force, moment
  constraint,    // index: of a contact, or, behind them, a loop; component: see ir/contact.hpp
  element,       // index: array of the function, filled in a section before; component: its element, column by column
  payload,       // index: payload number; component: mass, com (3), inertia xx xy xz yy yz zz
  implicit,      // index: one of ir/implicit_joints.hpp; component: what its damper and spring add to the step's equations
  parameter,     // index: one of the body's parameters (passes/parameters.hpp)
  state,         // index, component: a role of the body
  carried,       // index, component: a role of the parent (outwards), or what the children hand on, summed (inwards)
  of_body,       // index, component: a role of body `body` (−1: the base)
  received,      // index, component: what limbs attached to the body have handed on, kept per slot
  table,         // index: column of a segment's table of constants, one value per slot
  kept,          // index, component, body: an address of the rolled form (ir/rolled.hpp)
};

struct Input {
  InputKind kind;
  std::int32_t index = 0;
  std::int32_t component = 0;
  std::int32_t body = -1;
  bool operator==(const Input&) const = default;
};

// What a node was first made for: a sweep of the algorithm (or, counted on from there, pairs, projections and kernels) and the
// body (−1: the base).
inline constexpr std::int32_t all_bodies = -2;
struct Tag {
  std::int16_t sweep = -1;
  std::int32_t body = -1;
};

struct Node {
  Op op = Op::constant;
  NodeId a = no_node;
  NodeId b = no_node;
  double value = 0;  // op constant
  Input input{};     // op input
  Tag tag{};
};

class Graph {
 public:
  // Folding and sharing can be turned off to measure what they are worth; values do not change.
  struct Options {
    bool fold = true;
    bool share = true;
  };
  Graph() = default;
  explicit Graph(Options options) : options_(options) {}

  // Makes room for about so many nodes: growing to millions of them step by step takes as long as making them.
  void reserve(std::size_t nodes);

  // The node of that value: one there is already or a new one. Angles in rad; sign(x) is −1, 0 or 1, of what is no number
  // itself; where(a, b) is b where a is above zero, else zero. Operands are nodes of this graph.
  NodeId constant(double value);
  NodeId input(Input input);
  NodeId sine(NodeId a) { return unary(Op::sine, a); }
  NodeId cosine(NodeId a) { return unary(Op::cosine, a); }
  NodeId sign(NodeId a);
  NodeId negate(NodeId a);
  NodeId add(NodeId a, NodeId b);
  NodeId subtract(NodeId a, NodeId b);
  NodeId multiply(NodeId a, NodeId b);
  NodeId divide(NodeId a, NodeId b);
  NodeId where(NodeId a, NodeId b);
  // Any of them but an input; what an operation has no use for is ignored.
  NodeId make(Op op, NodeId a, NodeId b, double value);

  const Node& operator[](NodeId id) const { return nodes_[static_cast<std::size_t>(id)]; }
  NodeId size() const { return static_cast<NodeId>(nodes_.size()); }
  bool is_constant(NodeId id) const { return (*this)[id].op == Op::constant; }
  bool is_constant(NodeId id, double value) const { return is_constant(id) && (*this)[id].value == value; }

  // The same nodes of other inputs, of which no two that are needed may become one. f: Input → Input.
  template <class F>
  void rename_inputs(const F& f) {
    for (Node& n : nodes_)
      if (n.op == Op::input) n.input = f(n.input);
    resize(table_, table_.places.size());
  }

  // From open_scope() on nodes are made to be forgotten, all of them, by close_scope(). `own`: nodes that no others will read
  // but those of the scope and `readers`, which do already. They are known so that a long table need not be asked for them.
  void open_scope(const std::vector<NodeId>& own, const std::vector<NodeId>& readers);
  void close_scope();

  // Of the nodes made from here on.
  void set_tag(Tag tag) { tag_ = tag; }
  // And of those from this number on that are found again.
  void retag_from(NodeId first) { retagged_ = first; }

 private:
  NodeId unary(Op op, NodeId a);
  NodeId intern(Node node);
  NodeId find(const Node& node) const;  // one equal to it; no_node: there is none

  // By which nodes are found: open addressing; a power of two, at most half full.
  struct Table {
    std::vector<NodeId> places = std::vector<NodeId>(1024, no_node);
    std::size_t entries = 0;
  };

  // Where in the table a node equal to this one stands, or the free place where it belongs.
  std::size_t place_of(const Node& node, const Table& table) const;
  void resize(Table& table, std::size_t places);
  // Whether it can be found again.
  bool is_entry(const Node& node) const { return options_.share || node.op == Op::constant || node.op == Op::input; }
  bool of_scope(NodeId id) const { return id != no_node && (id >= scope_ || own_[static_cast<std::size_t>(id)]); }
  void enter(NodeId id, Table& table);

  Options options_{};
  std::vector<Node> nodes_;
  Table table_, table_of_scope_;  // the second is small and quickly emptied
  NodeId scope_ = no_node;        // its first node; no_node: none is open
  std::vector<bool> own_;         // of the nodes before it
  Tag tag_{};
  NodeId retagged_ = std::numeric_limits<NodeId>::max();
};

// The nodes of another graph once more, with other inputs; made one by one as they are asked for.
class Copy {
 public:
  Copy(const Graph& from, Graph& to) : from_(from), to_(to), made_(static_cast<std::size_t>(from.size()), no_node) {}

  // `input`: Input → node of the graph copied to.
  template <class InputNode>
  NodeId node(NodeId id, const InputNode& input) {
    return node_until(
        id, [](NodeId) { return no_node; }, input);
  }
  // All that some nodes need, in the order of the original, which is the order of the code.
  template <class InputNode>
  void nodes(const std::vector<NodeId>& wanted, const InputNode& input);
  // The same as node(), but that nodes for which `known` has one already stand for themselves: NodeId → node copied to, or
  // no_node.
  template <class Known, class InputNode>
  NodeId node_until(NodeId id, const Known& known, const InputNode& input);

 private:
  const Graph& from_;
  Graph& to_;
  std::vector<NodeId> made_, todo_;
};

// Marks every node that the roots need; result[id] is the number of uses (roots count as uses, operands of used nodes too).
std::vector<std::int32_t> uses(const Graph& graph, const std::vector<NodeId>& roots);
// The same of what a text names: a sine or cosine does not name its angle, which is computed elsewhere.
std::vector<std::int32_t> uses_in_text(const Graph& graph, const std::vector<NodeId>& roots);

// Calls f(input) for every input that the roots need, in the order of the graph.
template <class F>
void each_input(const Graph& graph, const std::vector<NodeId>& roots, const F& f) {
  const std::vector<std::int32_t> used = uses(graph, roots);
  for (NodeId id = 0; id < graph.size(); ++id)
    if (used[static_cast<std::size_t>(id)] > 0 && graph[id].op == Op::input) f(graph[id].input);
}

template <class InputNode>
void Copy::nodes(const std::vector<NodeId>& wanted, const InputNode& input) {
  const std::vector<std::int32_t> used = uses(from_, wanted);
  for (NodeId id = 0; id < from_.size(); ++id)
    if (used[static_cast<std::size_t>(id)] > 0) node(id, input);
}

template <class Known, class InputNode>
NodeId Copy::node_until(NodeId id, const Known& known, const InputNode& input) {
  const auto at = [this](NodeId n) -> NodeId& { return made_[static_cast<std::size_t>(n)]; };
  todo_.push_back(id);
  while (!todo_.empty()) {
    const NodeId next = todo_.back();
    if (at(next) != no_node) {
      todo_.pop_back();
      continue;
    }
    if (const NodeId there = known(next); there != no_node) {
      at(next) = there;
      continue;
    }
    const Node n = from_[next];
    // The operand made first in the original is made first here: the order of nodes is the order of the code.
    const NodeId first = n.b == no_node || n.a < n.b ? n.a : n.b, second = first == n.a ? n.b : n.a;
    if (first != no_node && at(first) == no_node) {
      todo_.push_back(first);
    } else if (second != no_node && at(second) == no_node) {
      todo_.push_back(second);
    } else {
      todo_.pop_back();
      const NodeId a = n.a == no_node ? no_node : at(n.a), b = n.b == no_node ? no_node : at(n.b);
      const NodeId made = n.op == Op::input ? input(n.input) : to_.make(n.op, a, b, n.value);
      at(next) = made;
    }
  }
  return at(id);
}

// Scalar operations. A sine and a cosine of the same angle count as one pair.
struct Operations {
  long add = 0;  // additions and subtractions
  long multiply = 0;
  long divide = 0;
  long sincos = 0;
  long total() const { return add + multiply + divide; }
  void count(Op op) {
    if (op == Op::add || op == Op::subtract) ++add;
    if (op == Op::multiply) ++multiply;
    if (op == Op::divide) ++divide;
  }
  Operations& operator+=(const Operations& o) {
    add += o.add, multiply += o.multiply, divide += o.divide, sincos += o.sincos;
    return *this;
  }
};
// Of one evaluation of the nodes used (see uses()).
Operations count(const Graph& graph, const std::vector<std::int32_t>& uses);

}  // namespace dalembert::ir
