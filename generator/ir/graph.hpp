// The scalar program: a hash-consed graph of scalar operations.
//
// Equal nodes are one node; constants fold and signs move outwards as nodes are made, so zeros and ones of the robot disappear
// where they arise and common subexpressions are shared without a pass of their own. A node's operands always have smaller
// numbers than the node: the order of creation is an order of evaluation.
#pragma once

#include <cstdint>
#include <vector>

namespace dalembert::ir {

using NodeId = std::int32_t;
inline constexpr NodeId no_node = -1;

enum class Op : std::uint8_t { constant, input, sine, cosine, sign, negate, add, subtract, multiply, divide };

// Where a value enters. `index` and `component` say which one, in the terms of `kind`.
enum class InputKind : std::uint8_t {
  position,  // index: position in q
  velocity,  // index: position in v
  gravity,   // component 0…2 of the gravity vector given at run time
  payload,   // index: payload number; component: mass, com (3), inertia xx xy xz yy yz zz
  table,     // index: column of the table of constants (one value per slot)
  state,     // index: role of a value kept in the workspace (one value per slot); component within the role
  carried,   // index, component: as state, but of the step before (towards the root or the leaves, as the loop runs)
};

struct Input {
  InputKind kind;
  std::int32_t index = 0;
  std::int32_t component = 0;
  bool operator==(const Input&) const = default;
};

// Which paragraph a node was first made in: phase I…III and the body (−1: base), for reading and counting.
struct Tag {
  std::int16_t phase = 0;
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

  // The node of that value: one there is already or a new one. Angles in rad; sign(x) is −1, 0 or 1. Operands are nodes of
  // this graph.
  NodeId constant(double value);
  NodeId input(Input input);
  NodeId sine(NodeId a) { return unary(Op::sine, a); }
  NodeId cosine(NodeId a) { return unary(Op::cosine, a); }
  NodeId sign(NodeId a) { return unary(Op::sign, a); }
  NodeId negate(NodeId a);
  NodeId add(NodeId a, NodeId b);
  NodeId subtract(NodeId a, NodeId b);
  NodeId multiply(NodeId a, NodeId b);
  NodeId divide(NodeId a, NodeId b);

  const Node& operator[](NodeId id) const { return nodes_[static_cast<std::size_t>(id)]; }
  NodeId size() const { return static_cast<NodeId>(nodes_.size()); }
  bool is_constant(NodeId id) const { return (*this)[id].op == Op::constant; }
  bool is_constant(NodeId id, double value) const { return is_constant(id) && (*this)[id].value == value; }

  // Of the nodes made from here on.
  void set_tag(Tag tag) { tag_ = tag; }

 private:
  NodeId unary(Op op, NodeId a);
  NodeId intern(Node node);
  NodeId find(Op op, NodeId a, NodeId b) const;

  // Where in the table a node equal to this one stands, or the free place where it belongs.
  std::size_t place_of(const Node& node) const;
  void resize_table(std::size_t places);

  Options options_{};
  std::vector<Node> nodes_;
  std::vector<NodeId> table_ = std::vector<NodeId>(1024, no_node);  // open addressing; a power of two, at most half full
  std::size_t entries_ = 0;
  Tag tag_{};
};

// Marks every node that the roots need; result[id] is the number of uses (roots count as uses, operands of used nodes too).
std::vector<std::int32_t> uses(const Graph& graph, const std::vector<NodeId>& roots);

// Scalar operations. A sine and a cosine of the same angle count as one pair.
struct Operations {
  long add = 0;  // additions and subtractions
  long multiply = 0;
  long divide = 0;
  long sincos = 0;
  long total() const { return add + multiply + divide; }
  Operations& operator+=(const Operations& o) {
    add += o.add, multiply += o.multiply, divide += o.divide, sincos += o.sincos;
    return *this;
  }
};
// Of one evaluation of the nodes used (see uses()).
Operations count(const Graph& graph, const std::vector<std::int32_t>& uses);

}  // namespace dalembert::ir
