#include "passes/write_out.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "dalembert/chain_shapes.hpp"
#include "passes/write_out_constraints.hpp"

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
    default: return "";
  }
}

class Writing {
 public:
  Writing(ir::Algorithm& algorithm, ir::Program& program, const ir::CoordinateTree& tree, bool whole)
      : algorithm_(algorithm),
        program_(program),
        graph_(program.graph),
        whole_(whole),
        matrices_(program.graph, tree, program.arrays.size()) {
    for (const ir::OutputElement& e : program.elements) of(e.array).set(e.row, e.column, e.node);
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
      begin(kernel.of_constraints() ? equation_of_constraints(kernel) : equation(kernel.kind), ir::all_bodies);
      switch (kernel.kind) {
        case Kind::factor: factor(kernel); break;
        case Kind::solve: solve(kernel); break;
        case Kind::invert: invert(kernel); break;
        case Kind::negative_product: negative_product(kernel); break;
        default: write_out_constraints(kernel, matrices_);
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

  // Rows of constraints, and products of whole matrices but for the smallest, unless no kernel is to stay.
  bool stays(const ir::Kernel& kernel) const {
    return !whole_ &&
           (kernel.of_constraints() || (kernel.kind == Kind::negative_product && matrices_.size() > most_of_products));
  }
  // Whether a kernel that stays has to do with the array.
  bool is_used(int array) const {
    return std::any_of(algorithm_.kernels.begin(), algorithm_.kernels.end(), [&](const ir::Kernel& kernel) {
      const std::vector<int> arrays = kernel.touched();
      return std::find(arrays.begin(), arrays.end(), array) != arrays.end();
    });
  }

  MatrixOfNodes& of(int array) { return matrices_.of(array); }

  // U and D of M = U D U', from the last coordinate to the first.
  void factor(const ir::Kernel& kernel) {
    const MatrixOfNodes& mass = of(kernel[Operand::mass]);
    MatrixOfNodes rest = mass;
    for (int k = matrices_.size() - 1; k >= 0; --k) {
      const NodeId pivot = rest.at(k, k), inverse = matrices_.reciprocal(pivot);
      of(kernel[Operand::diagonal]).set(k, 0, mass.at(k, k));
      of(kernel[Operand::pivots]).set(k, 0, pivot);
      of(kernel[Operand::factor]).set(k, k, pivot);
      for (const int i : matrices_.above(k)) {
        if (rest.at(i, k) == no_node) continue;
        const NodeId u = graph_.multiply(rest.at(i, k), inverse);
        of(kernel[Operand::factor]).set(i, k, u);
        for (int j = i; j >= 0; j = matrices_.directly_above(j))
          rest.set(j, i, matrices_.less(rest.at(j, i), u, rest.at(j, k)));
      }
    }
  }

  // (U D U')^-1 x.
  void solve(const ir::Kernel& kernel) {
    const MatrixOfNodes& u = of(kernel[Operand::factor]);
    MatrixOfNodes& x = of(kernel[Operand::to]);
    matrices_.eliminate_upwards(u, x);
    matrices_.substitute_downwards(
        u, [&u](int k) { return u.at(k, k); }, x);
  }

  // X = (U D U')^-1: row k of U' X = D^-1 U^-1, whose right side is zero before its diagonal.
  void invert(const ir::Kernel& kernel) {
    const MatrixOfNodes &u = of(kernel[Operand::factor]), &pivots = of(kernel[Operand::pivots]);
    MatrixOfNodes x;
    for (int k = 0; k < matrices_.size(); ++k)
      for (int j = 0; j <= k; ++j) {
        NodeId sum = j == k ? matrices_.reciprocal(pivots.at(k, 0)) : no_node;
        for (const int i : matrices_.above(k)) sum = matrices_.less(sum, u.at(i, k), x.at(i, j));
        x.set(k, j, sum);
        x.set(j, k, sum);
      }
    of(kernel[Operand::to]) = x;
    const int padded = kernel[Operand::inverse];
    for (const auto& [place, node] : x.nodes())  // by column and row
      of(padded).set(place.first * inverse_stride(matrices_.size()) + place.second, 0, node);
    inverses_[padded] = std::move(x);
  }

  void negative_product(const ir::Kernel& kernel) {
    const MatrixOfNodes &a = inverses_.at(kernel[Operand::inverse]), &b = of(kernel[Operand::efforts]);
    MatrixOfNodes& product = of(kernel[Operand::to]);  // the columns before the first are there
    for (int j = kernel.first; j < matrices_.size(); ++j)
      for (int i = 0; i < matrices_.size(); ++i) {
        NodeId sum = no_node;
        for (int k = 0; k < matrices_.size(); ++k) sum = matrices_.less(sum, a.at(i, k), b.at(k, j));
        product.set(i, j, sum);
      }
  }

  void collect() {
    program_.elements.clear();
    const std::vector<MatrixOfNodes>& all = matrices_.all();
    for (std::size_t array = 0; array < all.size(); ++array)
      for (const auto& [place, node] : all[array].nodes())
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
  const bool whole_;
  WrittenMatrices matrices_;
  std::map<int, MatrixOfNodes> inverses_;  // by the array that has them with padding
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

bool write_out_kernels(ir::Algorithm& algorithm, ir::Program& program, const ir::CoordinateTree& tree, bool whole,
                       std::span<const SectionBehind> behind) {
  const auto stays = [whole](const ir::Kernel& k) { return k.of_constraints() && !(whole && can_be_written_out(k)); };
  if (std::all_of(algorithm.kernels.begin(), algorithm.kernels.end(), stays)) return behind.empty();
  bool factored = false;  // else pivots are what articulated bodies leave
  for (const ir::Kernel& kernel : algorithm.kernels) {
    if (kernel.kind == Kind::factor && !has_diagonal(program, kernel[Operand::mass], tree.size())) return false;
    factored = factored || kernel.kind == Kind::factor;
    const bool divides = kernel.kind == Kind::invert || (whole && kernel.of_constraints());
    if (divides && !factored && kernel[Operand::pivots] >= 0 && !has_pivots(program, kernel[Operand::pivots], tree.size()))
      return false;
  }
  const auto any_stays = [&](const std::vector<ir::Kernel>& kernels) {
    return std::any_of(kernels.begin(), kernels.end(), stays);
  };
  const bool waits_for_constraints =
      any_stays(algorithm.kernels) || std::any_of(behind.begin(), behind.end(), [&](const SectionBehind& section) {
        return any_stays(section.algorithm.kernels) || !section.algorithm.projections.empty();
      });
  if ((whole || !behind.empty()) && waits_for_constraints) return false;
  Writing(algorithm, program, tree, whole).run(behind);
  return true;
}

}  // namespace dalembert::passes
