#include "passes/write_out_constraints.hpp"

#include <algorithm>
#include <array>

#include "dalembert/constraint_shapes.hpp"
#include "ir/contact.hpp"

namespace dalembert::passes {
namespace {

using ir::no_node;
using ir::NodeId;
using ir::Operand;
using Kind = ir::Kernel::Kind;
using Column = std::vector<NodeId>;  // no_node: zero

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// Of a matrix whose half below the diagonal is given, A = L D L'.
class Factors {
 public:
  Factors(WrittenMatrices& m, MatrixOfNodes a, int size) : m_(m), size_(size) {
    for (int k = 0; k < size; ++k) {
      inverse_.push_back(m.reciprocal(a.at(k, k)));
      for (int i = k + 1; i < size; ++i) lower_.set(i, k, m.product(a.at(i, k), inverse_.back()));
      for (int i = k + 1; i < size; ++i)
        for (int j = k + 1; j <= i; ++j) a.set(i, j, m.less(a.at(i, j), lower_.at(i, k), a.at(j, k)));
    }
  }

  // A^-1 x.
  Column solved(Column x) const {
    for (int k = 0; k < size_; ++k)
      for (int i = k + 1; i < size_; ++i) x[at(i)] = m_.less(x[at(i)], lower_.at(i, k), x[at(k)]);
    for (int k = size_ - 1; k >= 0; --k) {
      x[at(k)] = m_.product(x[at(k)], inverse_[at(k)]);
      for (int i = k + 1; i < size_; ++i) x[at(k)] = m_.less(x[at(k)], lower_.at(i, k), x[at(i)]);
    }
    return x;
  }

 private:
  WrittenMatrices& m_;
  const int size_;
  MatrixOfNodes lower_;
  Column inverse_;
};

class ConstraintWriting {
 public:
  ConstraintWriting(const ir::Kernel& kernel, WrittenMatrices& matrices)
      : kernel_(kernel), paths_(kernel.paths), m_(matrices), graph_(matrices.graph()) {
    for (int c = 0; c < paths_.count(); ++c)
      for (int r = paths_.first[at(c)]; r < paths_.first[at(c) + 1]; ++r) constraint_of_.push_back(c);
  }

  void delassus() {
    fill(false);
    MatrixOfNodes& to = m_.of(kernel_[Operand::to]);
    for (int r = 0; r < rows(); ++r)
      for (int s = 0; s <= r; ++s) {
        to.set(r, s, along_.at(r, s));
        to.set(s, r, along_.at(r, s));
      }
  }

  // f = W J_u y that leaves nothing to do for coordinates u without a motor; to becomes to - J' f.
  void support() {
    MatrixOfNodes& to = m_.of(kernel_[Operand::to]);
    const std::vector<int>& u = kernel_.undriven;
    const int size = static_cast<int>(u.size());
    std::vector<Column> own;  // J_u, per row
    Column lacking;
    const Column weights = this->weights();
    const MatrixOfNodes J = kernel_.by_wrenches() ? wrenches() : m_.of(kernel_[Operand::jacobian]);
    for (const int k : u) lacking.push_back(to.at(k, 0));
    for (int r = 0; r < rows(); ++r) {
      own.emplace_back();
      for (const int k : u) own.back().push_back(without_rounding(r, J.at(r, k), false));
    }
    MatrixOfNodes along;
    for (int i = 0; i < size; ++i)
      for (int r = 0; r < rows(); ++r) {
        const NodeId weighted = m_.product(weights[at(r)], own[at(r)][at(i)]);
        for (int j = 0; j <= i; ++j) along.set(i, j, m_.more(along.at(i, j), weighted, own[at(r)][at(j)]));
      }
    const Column held = held_of_undriven(along);
    for (int i = 0; i < size; ++i) along.set(i, i, m_.sum(along.at(i, i), held[at(i)]));
    const Factors factors(m_, along, size);
    Column y = factors.solved(lacking);
    for (int step = 1; step < kernel_.solutions; ++step) {
      Column right;
      for (int i = 0; i < size; ++i) right.push_back(m_.more(lacking[at(i)], held[at(i)], y[at(i)]));
      y = factors.solved(right);
    }
    Column forces;
    for (int r = 0; r < rows(); ++r) {
      NodeId sum = no_node;
      for (int i = 0; i < size; ++i) sum = m_.more(sum, own[at(r)][at(i)], y[at(i)]);
      forces.push_back(m_.product(weights[at(r)], sum));
      m_.of(kernel_[Operand::forces]).set(r, 0, forces.back());
    }
    if (kernel_.by_wrenches()) return less_wrenches(J, forces, to);
    for (int r = 0; r < rows(); ++r)
      for (int k = 0; k < m_.size(); ++k) to.set(k, 0, m_.less(to.at(k, 0), J.at(r, k), forces[at(r)]));
  }

  // x becomes M^-1 (x + J' f); of an impact, x + M^-1 J' f.
  void solve(bool impact) {
    MatrixOfNodes& x = m_.of(kernel_[Operand::to]);
    MatrixOfNodes change;
    if (!impact && !kernel_.by_limbs()) m_.eliminate_upwards(m_.of(kernel_[Operand::factor]), x);
    fill(true);
    Column known;
    for (int r = 0; r < rows(); ++r) {
      const NodeId right = or_zero(m_.of(kernel_[Operand::right]).at(r, 0));
      NodeId own = graph_.where(on(r), right);
      if (!impact)
        for (const auto& [k, y] : y_[at(r)]) own = m_.less(own, y, scaled(x, k));
      known.push_back(own);
    }
    const Column forces = forces_of(known);
    for (int r = 0; r < rows(); ++r) m_.of(kernel_[Operand::forces]).set(r, 0, forces[at(r)]);
    MatrixOfNodes& to = impact ? change : x;
    for (int r = 0; r < rows(); ++r)
      for (const auto& [k, y] : y_[at(r)]) {
        const NodeId pushed = kernel_.by_limbs() ? graph_.multiply(inverse_pivot(k), y) : y;
        to.set(k, 0, m_.more(to.at(k, 0), pushed, forces[at(r)]));
      }
    downwards(to);
    if (!impact) return;
    for (int k = 0; k < m_.size(); ++k) x.set(k, 0, m_.sum(x.at(k, 0), change.at(k, 0)));
  }

 private:
  int rows() const { return paths_.first.back(); }
  NodeId or_zero(NodeId node) { return node == no_node ? graph_.constant(0) : node; }
  NodeId given(int constraint, int component) { return graph_.input({ir::InputKind::constraint, constraint, component}); }

  // Above zero where the row acts; and 1 there, 0 elsewhere.
  NodeId on(int row) { return given(constraint_of_[at(row)], ir::contact_active); }
  NodeId one_where_on(int row) {
    const NodeId one = graph_.constant(1);
    return graph_.where(on(row), one);
  }

  NodeId inverse_pivot(int k) { return m_.reciprocal(m_.of(kernel_[Operand::pivots]).at(k, 0)); }
  // D^-1 x; by articulated bodies x comes so.
  NodeId scaled(const MatrixOfNodes& x, int k) {
    return kernel_.by_limbs() ? x.at(k, 0) : m_.product(x.at(k, 0), inverse_pivot(k));
  }

  // An element of J, but zero where it is nothing but rounding, or its row does not act.
  NodeId without_rounding(int row, NodeId element, bool masked) {
    if (element == no_node || (graph_.is_constant(element) && !masked)) return element;
    const NodeId acting = masked ? graph_.multiply(one_where_on(row), element) : element,
                 square = graph_.multiply(acting, element), least = graph_.constant(kernel_.unmoved * kernel_.unmoved),
                 above_rounding = graph_.subtract(square, least);
    return graph_.where(above_rounding, element);
  }

  // Y = U^-1 J', row by row of J, of the coordinates that are not zero in every state; and Y' D^-1 Y, below the diagonal.
  void fill(bool masked) {
    const MatrixOfNodes& J = m_.of(kernel_[Operand::jacobian]);
    for (int r = 0; r < rows(); ++r) {
      std::map<int, NodeId> y;
      const auto c = at(constraint_of_[at(r)]);
      const std::vector<int> path(paths_.path.begin() + paths_.begin[c], paths_.path.begin() + paths_.begin[c + 1]);
      const auto element = [&](int k) { return without_rounding(r, J.at(r, k), masked); };
      if (kernel_.by_limbs()) go_up(path, element, y);
      else eliminate(path, element, y);
      y_.push_back(std::move(y));
    }
    for (int r = 0; r < rows(); ++r) {
      std::map<int, NodeId> weighted;
      for (const auto& [k, y] : y_[at(r)]) weighted[k] = graph_.multiply(y, inverse_pivot(k));
      for (int s = 0; s <= r; ++s) {
        NodeId sum = no_node;
        for (const auto& [k, y] : y_[at(s)])
          if (const auto found = weighted.find(k); found != weighted.end()) sum = m_.more(sum, found->second, y);
        along_.set(r, s, sum);
      }
    }
  }

  template <class Element>
  void eliminate(const std::vector<int>& path, const Element& element, std::map<int, NodeId>& y) {
    const MatrixOfNodes& u = m_.of(kernel_[Operand::factor]);
    MatrixOfNodes rest;
    for (const int k : path) rest.set(k, 0, element(k));
    for (auto k = path.rbegin(); k != path.rend(); ++k) {
      if (rest.at(*k, 0) == no_node) continue;
      y[*k] = rest.at(*k, 0);
      for (const int i : m_.above(*k)) rest.set(i, 0, m_.less(rest.at(i, 0), u.at(i, *k), rest.at(*k, 0)));
    }
  }

  // The row's wrench on the base is handed up the limb by V and J: what each coordinate takes of it is its element of Y.
  template <class Element>
  void go_up(const std::vector<int>& path, const Element& element, std::map<int, NodeId>& y) {
    const MatrixOfNodes &V = m_.of(kernel_[Operand::gain]), &joint = m_.of(kernel_[Operand::joint]);
    std::array<NodeId, 6> rest{};
    for (int j = 0; j < 6; ++j) rest[at(j)] = element(j);
    for (auto k = path.rbegin(); k != path.rend(); ++k) {
      NodeId taken = no_node;
      for (int j = 0; j < 6; ++j) taken = m_.more(taken, joint.at(j, *k), rest[at(j)]);
      if (taken == no_node) continue;
      y[*k] = taken;
      for (int j = 0; j < 6; ++j) rest[at(j)] = m_.less(rest[at(j)], V.at(j, *k), taken);
    }
  }

  void downwards(MatrixOfNodes& x) {
    if (!kernel_.by_limbs()) {
      const auto pivot = [this](int k) { return m_.of(kernel_[Operand::pivots]).at(k, 0); };
      return m_.substitute_downwards(m_.of(kernel_[Operand::factor]), pivot, x);
    }
    const MatrixOfNodes &V = m_.of(kernel_[Operand::gain]), &joint = m_.of(kernel_[Operand::joint]);
    std::vector<std::array<NodeId, 6>> motion(at(m_.size()));
    for (int k = 0; k < m_.size(); ++k) {
      std::array<NodeId, 6>& own = motion[at(k)];
      own.fill(no_node);
      if (const int above = m_.directly_above(k); above >= 0) own = motion[at(above)];
      for (int j = 0; j < 6; ++j) x.set(k, 0, m_.less(x.at(k, 0), V.at(j, k), own[at(j)]));
      for (int j = 0; j < 6; ++j) own[at(j)] = m_.more(own[at(j)], joint.at(j, k), x.at(k, 0));
    }
  }

  // mu N of every row, N being the mean inverse inertia along the linear rows of its constraint, or the angular ones.
  Column held() {
    NodeId trace = no_node;
    for (int r = 0; r < rows(); ++r) trace = m_.sum(trace, along_.at(r, r));
    const NodeId share = m_.product(graph_.constant(least_share), trace);
    const NodeId one = graph_.constant(1), mu = graph_.constant(kernel_.mu);
    Column all;
    for (int c = 0; c < paths_.count(); ++c) {
      const int first = paths_.first[at(c)], behind = paths_.first[at(c) + 1], middle = first + paths_.linear[at(c)];
      for (const auto& [begin, end] : {std::pair(first, middle), std::pair(middle, behind)}) {
        NodeId sum = no_node;
        for (int r = begin; r < end; ++r) sum = m_.sum(sum, along_.at(r, r));
        const NodeId mean = or_zero(m_.more(share, graph_.constant(1.0 / std::max(1, end - begin)), sum));
        const NodeId of_mean = graph_.add(mean, graph_.subtract(one, graph_.where(mean, one)));
        for (int r = begin; r < end; ++r) {
          const NodeId own = or_zero(along_.at(r, r)), moved = graph_.where(own, mu),
                       unmoved = graph_.subtract(one, graph_.where(own, one)), times = graph_.add(moved, unmoved);
          const NodeId hold = graph_.multiply(times, of_mean);
          all.push_back(graph_.where(on(r), hold));
        }
      }
    }
    return all;
  }

  // What (Y' D^-1 Y + R) f = known comes to by proximal steps.
  Column forces_of(const Column& known) {
    const Column held = this->held();
    Column regular;
    MatrixOfNodes rest = along_;
    for (int r = 0; r < rows(); ++r) {
      const int c = constraint_of_[at(r)];
      regular.push_back(given(c, paths_.regularization[at(c)] + r - paths_.first[at(c)]));
      const NodeId one = graph_.constant(1), acts = one_where_on(r), off = graph_.subtract(one, acts);
      const NodeId more = m_.sum(m_.sum(held[at(r)], regular.back()), off);
      rest.set(r, r, m_.sum(rest.at(r, r), more));
    }
    const Factors factors(m_, std::move(rest), rows());
    Column f = factors.solved(known);
    for (int step = 2; step < kernel_.solutions; ++step) {
      Column right;
      for (int r = 0; r < rows(); ++r) right.push_back(m_.more(known[at(r)], held[at(r)], f[at(r)]));
      f = factors.solved(right);
    }
    Column missing;
    for (int r = 0; r < rows(); ++r) {
      NodeId own = m_.less(known[at(r)], regular[at(r)], f[at(r)]);
      for (int s = 0; s < rows(); ++s) own = m_.less(own, along_.at(std::max(r, s), std::min(r, s)), f[at(s)]);
      missing.push_back(own);
    }
    const Column change = factors.solved(missing);
    for (int r = 0; r < rows(); ++r) f[at(r)] = m_.sum(f[at(r)], change[at(r)]);
    return f;
  }

  // Of rows in inverse dynamics, as parts of their sum: how large all are does not matter.
  Column weights() {
    // Some hundred of the largest numbers have a sum.
    const NodeId part = graph_.constant(0x1p-7), smallest = graph_.constant(kernel_.smallest);
    Column all;
    NodeId sum = no_node;
    for (int r = 0; r < rows(); ++r) {
      const NodeId own = weight(r);
      all.push_back(graph_.multiply(part, own));
      sum = m_.sum(sum, all.back());
    }
    const NodeId more = graph_.subtract(sum, smallest), inverse = m_.reciprocal(sum), scale = graph_.where(more, inverse);
    for (NodeId& own : all) own = graph_.multiply(own, scale);
    return all;
  }
  // Zero of one that does not act, and in the place of what is no weight.
  NodeId weight(int row) {
    const int c = constraint_of_[at(row)], own_row = row - paths_.first[at(c)],
              count = paths_.first[at(c) + 1] - paths_.first[at(c)];
    const NodeId own = given(c, paths_.regularization[at(c)] + count + own_row), most = graph_.constant(kernel_.largest),
                 left = graph_.subtract(most, own), finite = graph_.where(left, own), positive = graph_.where(own, finite);
    return graph_.where(on(row), positive);
  }

  // mu N of the coordinates without a motor: N is A's diagonal, of the base its mean along the axes and about them.
  Column held_of_undriven(const MatrixOfNodes& along) {
    const NodeId one = graph_.constant(1), mu = graph_.constant(kernel_.mu), least = graph_.constant(kernel_.least);
    const int size = static_cast<int>(kernel_.undriven.size());
    Column all;
    for (int i = 0; i < size; ++i) {
      NodeId N = along.at(i, i);
      if (i < kernel_.base_undriven) {
        const int first = i / 3 * 3;
        const NodeId two = m_.sum(along.at(first, first), along.at(first + 1, first + 1)),
                     three = m_.sum(two, along.at(first + 2, first + 2));
        N = m_.product(three, graph_.constant(1.0 / 3));
      }
      N = or_zero(N);
      const NodeId more = graph_.subtract(N, least), own = graph_.where(more, N),
                   none = graph_.subtract(one, graph_.where(more, one));
      all.push_back(graph_.multiply(mu, graph_.add(own, none)));
    }
    return all;
  }

  // The rows as wrenches on the base, 6 columns.
  MatrixOfNodes wrenches() {
    if (kernel_.kind != Kind::support_at_points) return m_.of(kernel_[Operand::jacobian]);
    const MatrixOfNodes &points = m_.of(kernel_[Operand::points]), &turn = m_.of(kernel_[Operand::turn]);
    MatrixOfNodes all;
    for (int r = 0; r < rows(); ++r) {
      const int c = constraint_of_[at(r)], i = r - paths_.first[at(c)], axis = i % 3, next = (axis + 1) % 3,
                behind = (axis + 2) % 3;
      for (int j = 0; j < 3; ++j) {
        if (i >= 3) {
          all.set(r, 3 + j, turn.at(axis, j));
          continue;
        }
        all.set(r, j, turn.at(axis, j));  // and x cross it: along the axes that follow it
        const NodeId one = m_.product(points.at(behind, c), turn.at(next, j));
        all.set(r, 3 + j, m_.less(one, points.at(next, c), turn.at(behind, j)));
      }
    }
    return all;
  }

  void less_wrenches(const MatrixOfNodes& rows_on_base, const Column& forces, MatrixOfNodes& to) {
    const MatrixOfNodes& axes = m_.of(kernel_[Operand::axes]);
    std::map<int, int> column_of;
    for (const int k : paths_.moving())
      if (k >= 6) column_of.emplace(k, static_cast<int>(column_of.size()));
    for (int c = 0; c < paths_.count(); ++c) {
      std::array<NodeId, 6> wrench{};
      for (int j = 0; j < 6; ++j) {
        wrench[at(j)] = no_node;
        for (int r = paths_.first[at(c)]; r < paths_.first[at(c) + 1]; ++r)
          wrench[at(j)] = m_.more(wrench[at(j)], rows_on_base.at(r, j), forces[at(r)]);
        to.set(j, 0, m_.difference(to.at(j, 0), wrench[at(j)]));
      }
      for (int i = paths_.begin[at(c)]; i < paths_.begin[at(c) + 1]; ++i)
        if (const int k = paths_.path[at(i)]; k >= 6)
          for (int j = 0; j < 6; ++j) to.set(k, 0, m_.less(to.at(k, 0), axes.at(j, column_of.at(k)), wrench[at(j)]));
    }
  }

  const ir::Kernel& kernel_;
  const ir::ConstraintPaths& paths_;
  WrittenMatrices& m_;
  ir::Graph& graph_;
  std::vector<int> constraint_of_;        // per row
  std::vector<std::map<int, NodeId>> y_;  // per row, by coordinate
  MatrixOfNodes along_;
};

}  // namespace

bool can_be_written_out(const ir::Kernel& kernel) {
  switch (kernel.kind) {
    case Kind::delassus:
    case Kind::delassus_by_limbs:
    case Kind::solve_constrained:
    case Kind::solve_constrained_by_limbs:
    case Kind::impact:
    case Kind::impact_by_limbs:
    case Kind::support:
    case Kind::support_by_wrenches:
    case Kind::support_at_points: return kernel[Operand::response] < 0;
    default: return false;
  }
}

const char* equation_of_constraints(const ir::Kernel& kernel) {
  switch (kernel.kind) {
    case Kind::delassus:
    case Kind::delassus_by_limbs: return "J M^-1 J' = Y' D^-1 Y, Y = U^-1 J'";
    case Kind::impact:
    case Kind::impact_by_limbs: return "J M^-1 J' f = b, v + M^-1 J' f";
    case Kind::support:
    case Kind::support_by_wrenches:
    case Kind::support_at_points: return "tau - J' f, f = W J_u y, zero at coordinates u without a motor";
    default: return "M dv = e + J' f, J dv = b";
  }
}

void write_out_constraints(const ir::Kernel& kernel, WrittenMatrices& matrices) {
  ConstraintWriting writing(kernel, matrices);
  switch (kernel.kind) {
    case Kind::delassus:
    case Kind::delassus_by_limbs: return writing.delassus();
    case Kind::impact:
    case Kind::impact_by_limbs: return writing.solve(true);
    case Kind::support:
    case Kind::support_by_wrenches:
    case Kind::support_at_points: return writing.support();
    default: return writing.solve(false);
  }
}

}  // namespace dalembert::passes
