#include "passes/write_out.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "dalembert/chain_shapes.hpp"

namespace dalembert::passes {
namespace {

using ir::no_node;
using ir::NodeId;
using ir::Operand;
using Kind = ir::Kernel::Kind;

const char* equation(Kind kind) {
  switch (kind) {
    case Kind::factor: return "M = U D U', from the last coordinate to the first";
    case Kind::solve: return "(U D U')^-1 (tau - (C v + g))";
    case Kind::invert: return "X = (U D U')^-1: U' X = D^-1 U^-1, row by row";
    case Kind::negative_product: return "-X times the derivatives of inverse dynamics";
    default: return "";  // kernels of constraints are called
  }
}

// A matrix of nodes: what is zero in every state is not there.
class Matrix {
 public:
  NodeId at(int row, int column) const {
    const auto found = nodes_.find({column, row});
    return found == nodes_.end() ? no_node : found->second;
  }
  void set(int row, int column, NodeId node) {
    if (node != no_node) nodes_[{column, row}] = node;
  }
  const std::map<std::pair<int, int>, NodeId>& nodes() const { return nodes_; }  // by column and row

 private:
  std::map<std::pair<int, int>, NodeId> nodes_;
};

class Writing {
 public:
  Writing(ir::Algorithm& algorithm, ir::Program& program, const ir::CoordinateTree& tree, bool products)
      : algorithm_(algorithm),
        program_(program),
        graph_(program.graph),
        tree_(tree),
        products_(products),
        matrices_(program.arrays.size()) {
    for (const ir::OutputElement& e : program.elements) of(e.array).set(e.row, e.column, e.node);
    for (int k = 0; k < tree.size(); ++k) {
      above_.emplace_back();
      for (int i = tree.above[static_cast<std::size_t>(k)]; i >= 0; i = tree.above[static_cast<std::size_t>(i)])
        above_.back().push_back(i);
    }
  }

  void run(std::span<const SectionBehind> behind) {
    write_out(std::exchange(algorithm_.kernels, {}));
    for (const SectionBehind& section : behind) {
      append(section.algorithm, section.program);
      write_out(section.algorithm.kernels);
    }
    collect();
    drop_unread();
  }

 private:
  void write_out(const std::vector<ir::Kernel>& kernels) {
    for (const ir::Kernel& kernel : kernels) {
      if (stays(kernel)) {
        algorithm_.kernels.push_back(kernel);
        continue;
      }
      begin(equation(kernel.kind), ir::all_bodies);
      switch (kernel.kind) {
        case Kind::factor: factor(kernel); break;
        case Kind::solve: solve(kernel); break;
        case Kind::invert: invert(kernel); break;
        default: negative_product(kernel);
      }
    }
  }

  // Of the nodes made from here on.
  void begin(const std::string& equation, int body) {
    std::vector<std::string>& equations = algorithm_.written_out;
    const auto found = std::find(equations.begin(), equations.end(), equation);
    const auto number = algorithm_.written() + static_cast<std::size_t>(found - equations.begin());
    if (found == equations.end()) equations.push_back(equation);
    graph_.set_tag({static_cast<std::int16_t>(number), body});
  }

  // The nodes of a section behind: what it reads of those before are nodes too.
  void append(const ir::Algorithm& section, const ir::Program& program) {
    algorithm_.arrays = section.arrays;
    matrices_.resize(section.arrays.size());
    const auto element = [this](int array, int row, int column) {
      const NodeId node = of(array).at(row, column);
      return node == no_node ? graph_.constant(0) : node;
    };
    const auto input = [&](const ir::Input& in) {
      if (in.kind == ir::InputKind::acceleration) return element(section.section.accelerations, in.index, 0);
      if (in.kind != ir::InputKind::element) return graph_.input(in);
      const int rows = section.arrays[static_cast<std::size_t>(in.index)].rows;
      return element(in.index, in.component % rows, in.component / rows);
    };
    ir::Copy copy(program.graph, graph_);
    const std::vector<std::int32_t> used = ir::uses(program.graph, program.roots());
    std::vector<std::string>& names = program_.names;
    for (NodeId id = 0; id < program.graph.size(); ++id) {
      if (used[static_cast<std::size_t>(id)] == 0) continue;
      const ir::Tag tag = program.graph[id].tag;
      if (tag.sweep >= 0) begin(section.equation(tag), tag.body);
      else graph_.set_tag(tag);
      const auto made = static_cast<std::size_t>(copy.node(id, input));
      if (program.names.empty()) continue;
      names.resize(std::max(names.size(), made + 1));
      if (names[made].empty()) names[made] = program.names[static_cast<std::size_t>(id)];
    }
    for (const ir::OutputElement& e : program.elements) of(e.array).set(e.row, e.column, copy.node(e.node, input));
    if (!section.guard) return;
    std::vector<int>& cleared = algorithm_.guard->arrays;
    for (const int array : section.guard->arrays)
      if (std::find(cleared.begin(), cleared.end(), array) == cleared.end()) cleared.push_back(array);
  }

  // Rows of constraints; and products of whole matrices, but for the smallest.
  bool stays(const ir::Kernel& kernel) const {
    return kernel.of_constraints() || (kernel.kind == Kind::negative_product && !products_ && tree_.size() > most_of_products);
  }
  // Whether a kernel that stays has to do with the array.
  bool is_used(int array) const {
    return std::any_of(algorithm_.kernels.begin(), algorithm_.kernels.end(), [&](const ir::Kernel& kernel) {
      const std::vector<int> arrays = kernel.touched();
      return std::find(arrays.begin(), arrays.end(), array) != arrays.end();
    });
  }

  Matrix& of(int array) { return matrices_[static_cast<std::size_t>(array)]; }
  const std::vector<int>& above(int k) const { return above_[static_cast<std::size_t>(k)]; }  // the nearest first

  // x - a b, where any may be zero.
  NodeId less(NodeId x, NodeId a, NodeId b) {
    if (a == no_node || b == no_node) return x;
    const NodeId product = graph_.multiply(a, b);
    return x == no_node ? graph_.negate(product) : graph_.subtract(x, product);
  }
  NodeId reciprocal(NodeId pivot) { return graph_.divide(graph_.constant(1), pivot); }

  // U and D of M = U D U', from the last coordinate to the first.
  void factor(const ir::Kernel& kernel) {
    const Matrix& mass = of(kernel[Operand::mass]);
    Matrix rest = mass;
    for (int k = tree_.size() - 1; k >= 0; --k) {
      const NodeId pivot = rest.at(k, k), inverse = reciprocal(pivot);
      of(kernel[Operand::diagonal]).set(k, 0, mass.at(k, k));
      of(kernel[Operand::pivots]).set(k, 0, pivot);
      of(kernel[Operand::factor]).set(k, k, pivot);
      for (const int i : above(k)) {
        if (rest.at(i, k) == no_node) continue;
        const NodeId u = graph_.multiply(rest.at(i, k), inverse);
        of(kernel[Operand::factor]).set(i, k, u);
        for (int j = i; j >= 0; j = tree_.above[static_cast<std::size_t>(j)])
          rest.set(j, i, less(rest.at(j, i), u, rest.at(j, k)));
      }
    }
  }

  // (U D U')^-1 x.
  void solve(const ir::Kernel& kernel) {
    const Matrix& u = of(kernel[Operand::factor]);
    Matrix& x = of(kernel[Operand::to]);
    for (int k = tree_.size() - 1; k >= 0; --k)
      for (const int i : above(k)) x.set(i, 0, less(x.at(i, 0), u.at(i, k), x.at(k, 0)));
    for (int k = 0; k < tree_.size(); ++k) {
      if (x.at(k, 0) != no_node) x.set(k, 0, graph_.multiply(x.at(k, 0), reciprocal(u.at(k, k))));
      for (const int i : above(k)) x.set(k, 0, less(x.at(k, 0), u.at(i, k), x.at(i, 0)));
    }
  }

  // X = (U D U')^-1: row k of U' X = D^-1 U^-1, whose right side is zero before its diagonal.
  void invert(const ir::Kernel& kernel) {
    const Matrix &u = of(kernel[Operand::factor]), &pivots = of(kernel[Operand::pivots]);
    Matrix x;
    for (int k = 0; k < tree_.size(); ++k)
      for (int j = 0; j <= k; ++j) {
        NodeId sum = j == k ? reciprocal(pivots.at(k, 0)) : no_node;
        for (const int i : above(k)) sum = less(sum, u.at(i, k), x.at(i, j));
        x.set(k, j, sum);
        x.set(j, k, sum);
      }
    of(kernel[Operand::to]) = x;
    const int padded = kernel[Operand::inverse];
    for (const auto& [place, node] : x.nodes())  // by column and row
      of(padded).set(place.first * inverse_stride(tree_.size()) + place.second, 0, node);
    inverses_[padded] = std::move(x);
  }

  void negative_product(const ir::Kernel& kernel) {
    const Matrix &a = inverses_.at(kernel[Operand::inverse]), &b = of(kernel[Operand::efforts]);
    Matrix& product = of(kernel[Operand::to]);  // the columns before the first are there
    for (int j = kernel.first; j < tree_.size(); ++j)
      for (int i = 0; i < tree_.size(); ++i) {
        NodeId sum = no_node;
        for (int k = 0; k < tree_.size(); ++k) sum = less(sum, a.at(i, k), b.at(k, j));
        product.set(i, j, sum);
      }
  }

  void collect() {
    program_.elements.clear();
    for (std::size_t array = 0; array < matrices_.size(); ++array)
      for (const auto& [place, node] : matrices_[array].nodes())
        if (!graph_.is_constant(node, 0))
          program_.elements.push_back({static_cast<int>(array), place.second, place.first, node});
    program_.names.resize(program_.names.empty() ? 0 : static_cast<std::size_t>(graph_.size()));
  }

  // Arrays between that only kernels have read: they are not stored, nor cleared.
  void drop_unread() {
    std::optional<ir::Guard>& guard = algorithm_.guard;
    for (std::size_t a = 0; a < algorithm_.arrays.size(); ++a) {
      const int index = static_cast<int>(a);
      const bool checked = guard && (index == guard->pivots || index == guard->diagonal || guard->tells_by(index));
      const bool projected = std::any_of(algorithm_.projections.begin(), algorithm_.projections.end(),
                                         [&](const ir::Projection& p) { return index == p.bodies || index == p.joints; });
      algorithm_.arrays[a].written_out =
          algorithm_.arrays[a].internal && !checked && !projected && !is_used(index) && index != algorithm_.factor;
    }
    program_.arrays = algorithm_.arrays;
    const auto written_out = [&](int array) { return program_.arrays[static_cast<std::size_t>(array)].written_out; };
    std::erase_if(program_.elements, [&](const ir::OutputElement& e) { return written_out(e.array); });
    if (guard) std::erase_if(guard->arrays, written_out);
  }

  ir::Algorithm& algorithm_;
  ir::Program& program_;
  ir::Graph& graph_;
  const ir::CoordinateTree& tree_;
  const bool products_;
  std::vector<Matrix> matrices_;
  std::map<int, Matrix> inverses_;  // by the array that has them with padding
  std::vector<std::vector<int>> above_;
};

}  // namespace

namespace {

// Whether there is something to divide by at every coordinate: a body without mass may leave nothing in any state, which is
// left to the runtime, which tells. place: where in an array a coordinate's number is.
template <class Place>
bool is_full(const ir::Program& program, int array, int size, const Place& place) {
  return size == std::count_if(program.elements.begin(), program.elements.end(),
                               [&](const ir::OutputElement& e) { return e.array == array && place(e); });
}
bool has_diagonal(const ir::Program& program, int matrix, int size) {
  return is_full(program, matrix, size, [](const ir::OutputElement& e) { return e.row == e.column; });
}
bool has_pivots(const ir::Program& program, int pivots, int size) {
  return is_full(program, pivots, size, [](const ir::OutputElement&) { return true; });
}

}  // namespace

bool write_out_kernels(ir::Algorithm& algorithm, ir::Program& program, const ir::CoordinateTree& tree, bool products,
                       std::span<const SectionBehind> behind) {
  const auto of_constraints = [](const ir::Kernel& k) { return k.of_constraints(); };
  if (std::all_of(algorithm.kernels.begin(), algorithm.kernels.end(), of_constraints)) return behind.empty();
  bool factored = false;  // else pivots are what articulated bodies leave
  for (const ir::Kernel& kernel : algorithm.kernels) {
    if (kernel.kind == Kind::factor && !has_diagonal(program, kernel[Operand::mass], tree.size())) return false;
    factored = factored || kernel.kind == Kind::factor;
    if (kernel.kind == Kind::invert && !factored && !has_pivots(program, kernel[Operand::pivots], tree.size())) return false;
  }
  const bool waits_for_constraints =
      std::any_of(algorithm.kernels.begin(), algorithm.kernels.end(), of_constraints) ||
      std::any_of(behind.begin(), behind.end(), [&](const SectionBehind& section) {
        const std::vector<ir::Kernel>& kernels = section.algorithm.kernels;
        return std::any_of(kernels.begin(), kernels.end(), of_constraints) || !section.algorithm.projections.empty();
      });
  if (!behind.empty() && waits_for_constraints) return false;
  Writing(algorithm, program, tree, products).run(behind);
  return true;
}

}  // namespace dalembert::passes
