// Matrices of nodes, and what kernels do with them: what writing them out (passes/write_out.hpp) works on.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "ir/coordinate_tree.hpp"
#include "ir/graph.hpp"

namespace dalembert::passes {

// What is zero in every state is not there.
class MatrixOfNodes {
 public:
  ir::NodeId at(int row, int column) const {
    const auto found = nodes_.find({column, row});
    return found == nodes_.end() ? ir::no_node : found->second;
  }
  void set(int row, int column, ir::NodeId node) {
    if (node != ir::no_node) nodes_[{column, row}] = node;
  }
  const std::map<std::pair<int, int>, ir::NodeId>& nodes() const { return nodes_; }  // by column and row

 private:
  std::map<std::pair<int, int>, ir::NodeId> nodes_;
};

// The arrays of a function, by their numbers, and arithmetic of which any operand may be zero: no node.
class WrittenMatrices {
 public:
  WrittenMatrices(ir::Graph& graph, const ir::CoordinateTree& tree, std::size_t arrays)
      : graph_(graph), tree_(tree), matrices_(arrays) {
    for (int k = 0; k < tree.size(); ++k) {
      above_.emplace_back();
      for (int i = directly_above(k); i >= 0; i = directly_above(i)) above_.back().push_back(i);
    }
  }

  ir::Graph& graph() { return graph_; }
  int size() const { return tree_.size(); }
  int directly_above(int k) const { return tree_.above[static_cast<std::size_t>(k)]; }
  const std::vector<int>& above(int k) const { return above_[static_cast<std::size_t>(k)]; }  // the nearest first

  void resize(std::size_t arrays) { matrices_.resize(arrays); }
  const std::vector<MatrixOfNodes>& all() const { return matrices_; }
  MatrixOfNodes& of(int array) { return matrices_[static_cast<std::size_t>(array)]; }

  ir::NodeId product(ir::NodeId a, ir::NodeId b) {
    return a == ir::no_node || b == ir::no_node ? ir::no_node : graph_.multiply(a, b);
  }
  ir::NodeId sum(ir::NodeId a, ir::NodeId b) { return a == ir::no_node ? b : b == ir::no_node ? a : graph_.add(a, b); }
  ir::NodeId difference(ir::NodeId a, ir::NodeId b) {
    return b == ir::no_node ? a : a == ir::no_node ? graph_.negate(b) : graph_.subtract(a, b);
  }
  // x + a b, x - a b.
  ir::NodeId more(ir::NodeId x, ir::NodeId a, ir::NodeId b) { return sum(x, product(a, b)); }
  ir::NodeId less(ir::NodeId x, ir::NodeId a, ir::NodeId b) { return difference(x, product(a, b)); }
  ir::NodeId reciprocal(ir::NodeId pivot) { return graph_.divide(graph_.constant(1), pivot); }

  // By M = U D U', U above the diagonal of `factor`: x = U^-1 x, and x = U'^-1 D^-1 x. pivot: coordinate → node of D.
  void eliminate_upwards(const MatrixOfNodes& factor, MatrixOfNodes& x) {
    for (int k = size() - 1; k >= 0; --k)
      for (const int i : above(k)) x.set(i, 0, less(x.at(i, 0), factor.at(i, k), x.at(k, 0)));
  }
  template <class Pivot>
  void substitute_downwards(const MatrixOfNodes& factor, const Pivot& pivot, MatrixOfNodes& x) {
    for (int k = 0; k < size(); ++k) {
      if (x.at(k, 0) != ir::no_node) x.set(k, 0, graph_.multiply(x.at(k, 0), reciprocal(pivot(k))));
      for (const int i : above(k)) x.set(k, 0, less(x.at(k, 0), factor.at(i, k), x.at(i, 0)));
    }
  }

 private:
  ir::Graph& graph_;
  const ir::CoordinateTree& tree_;
  std::vector<MatrixOfNodes> matrices_;
  std::vector<std::vector<int>> above_;
};

}  // namespace dalembert::passes
