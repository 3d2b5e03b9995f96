#include "interpret_kernels.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <dalembert/constraint_shapes.hpp>
#include <dalembert/pivots.hpp>
#include <utility>

#include "dalembert/chain_shapes.hpp"

namespace dalembert::ir {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// What the guard of a function finds in its arrays, as dalembert/factor.hpp has it. above: the coordinate above each.
FactorStatus<double> guard_status(const Algorithm& algorithm, Arrays& arrays, const std::vector<int>& above) {
  const Guard& guard = *algorithm.guard;
  const auto array = [&](int index) -> MatrixXd& { return arrays[algorithm.arrays[static_cast<std::size_t>(index)].name]; };
  const VectorXd pivots = array(guard.pivots), diagonal = array(guard.diagonal);
  if ((pivots.array() > detail::least_ratio<double>() * diagonal.array() && pivots.array() > 0).all()) return {};
  const Index n = pivots.size();
  const double rounding = detail::rounding_left<double>(static_cast<int>(n));
  if (guard.factor >= 0) {
    VectorXd x(n);
    return detail::bounded_status<double>(static_cast<int>(n), above.data(), array(guard.factor).data(), pivots.data(),
                                          diagonal.data(), x.data());
  }
  // E of every coordinate, as a matrix.
  const MatrixXd &gain = array(guard.gain), &joint = array(guard.joint);
  std::vector<MatrixXd> beyond(static_cast<std::size_t>(n), MatrixXd::Zero(6, 6));
  for (Index k = n; k-- > 0;) {
    const MatrixXd& E = beyond[static_cast<std::size_t>(k)];
    const VectorXd V = gain.col(k), J = joint.col(k);
    if (!detail::exceeds(pivots[k], diagonal[k] + std::max(0.0, J.dot(E * J)), rounding))
      return {static_cast<int>(k), pivots[k]};
    const MatrixXd P = MatrixXd::Identity(6, 6) - J * V.transpose();
    if (const int p = above[static_cast<std::size_t>(k)]; p >= 0)
      beyond[static_cast<std::size_t>(p)] += P.transpose() * E * P + diagonal[k] * V * V.transpose();
  }
  return {};
}

// U D U', U above the diagonal of an array.
MatrixXd with_ones(const MatrixXd& factor) {
  MatrixXd upper = factor.triangularView<Eigen::StrictlyUpper>();
  upper.diagonal().setOnes();
  return upper;
}
MatrixXd product(const MatrixXd& upper, const VectorXd& pivots) { return upper * pivots.asDiagonal() * upper.transpose(); }

// M^-1 from its room: as straight lines leave it, or as it was made here.
MatrixXd without_room(const MatrixXd& room, Index n) {
  if (room.cols() > 1) return room;
  return Eigen::Map<const MatrixXd, 0, Eigen::OuterStride<>>(room.data(), n, n,
                                                             Eigen::OuterStride<>(inverse_stride(static_cast<int>(n))));
}

class KernelRun {
 public:
  KernelRun(const Algorithm& algorithm, Arrays& arrays, const std::vector<int>& above, const Acting& acting,
            const Kernel& kernel)
      : algorithm_(algorithm), arrays_(arrays), above_(above), acting_(acting), kernel_(kernel) {}

  void run() {
    using Kind = Kernel::Kind;
    switch (kernel_.kind) {
      case Kind::factor: return factor();
      case Kind::solve: return solve();
      case Kind::invert: return invert();
      case Kind::negative_product: return negative_product();
      case Kind::delassus:
      case Kind::delassus_by_limbs: return delassus();
      case Kind::solve_constrained:
      case Kind::solve_constrained_by_limbs: return solve_constrained();
      case Kind::impact:
      case Kind::impact_by_limbs: return impact();
      case Kind::support:
      case Kind::support_by_wrenches:
      case Kind::support_at_points: return support();
      case Kind::respond:
      case Kind::respond_as_solved: return respond();
      case Kind::derive: return derive();
    }
  }

 private:
  bool has(Operand operand) const { return kernel_[operand] >= 0; }
  MatrixXd& of(Operand operand) { return arrays_[algorithm_.arrays[static_cast<std::size_t>(kernel_[operand])].name]; }

  // One coordinate after another, from the last: U and D in one matrix, and D alone.
  void factor() {
    MatrixXd M = of(Operand::mass);
    MatrixXd &upper = of(Operand::factor), &pivots = of(Operand::pivots);
    of(Operand::diagonal) = M.diagonal();
    upper.setZero();
    for (Index k = M.rows(); k-- > 0;) {
      upper(k, k) = pivots(k, 0) = M(k, k);
      upper.col(k).head(k) = M.col(k).head(k) / M(k, k);
      M.topLeftCorner(k, k) -= M(k, k) * upper.col(k).head(k) * upper.col(k).head(k).transpose();
    }
  }

  void solve() {
    const MatrixXd& factor = of(Operand::factor);
    of(Operand::to) = product(with_ones(factor), factor.diagonal()).inverse() * of(Operand::to);
  }

  void invert() {
    of(Operand::to) = of(Operand::inverse) = product(with_ones(of(Operand::factor)), of(Operand::pivots).col(0)).inverse();
  }

  void negative_product() {
    const MatrixXd& efforts = of(Operand::efforts);
    const Index count = efforts.cols() - kernel_.first;
    of(Operand::to).rightCols(count) = -without_room(of(Operand::inverse), efforts.rows()) * efforts.rightCols(count);
  }

  // One for each row that acts, zero for others.
  VectorXd acts() const {
    const ConstraintPaths& paths = kernel_.paths;
    VectorXd all = VectorXd::Ones(paths.first.back());
    for (std::size_t c = 0; c < acting_.active.size(); ++c)
      if (!acting_.active[c]) all.segment(paths.first[c], paths.first[c + 1] - paths.first[c]).setZero();
    return all;
  }

  // J of rows, rounding being nothing.
  MatrixXd rows() {
    const MatrixXd& J = of(Operand::jacobian);
    return (J.array().abs() <= Proximal<double>::unmoved).select(MatrixXd::Zero(J.rows(), J.cols()), J);
  }

  // Rows along the world's axes, as wrenches on the base.
  MatrixXd wrenches_at_points() {
    const MatrixXd turn = of(Operand::turn);
    const ConstraintPaths& paths = kernel_.paths;
    MatrixXd wrenches = MatrixXd::Zero(paths.first.back(), 6);
    for (std::size_t c = 0; c + 1 < paths.first.size(); ++c) {
      const Eigen::Vector3d x = of(Operand::points).col(static_cast<Index>(c));
      for (int r = paths.first[c]; r < paths.first[c + 1]; ++r) {
        const int i = r - paths.first[c];
        const Eigen::Vector3d along = Eigen::Vector3d::Unit(i % 3);
        if (i < 3) wrenches.row(r) << along.transpose() * turn, x.cross(along).transpose() * turn;
        else wrenches.row(r).tail(3) = along.transpose() * turn;
      }
    }
    return wrenches;
  }

  // J of the rows' wrenches on the base and of the axes that coordinates move along, 6 x n.
  MatrixXd rows_along(const MatrixXd& joint) {
    const MatrixXd wrenches = kernel_.kind == Kernel::Kind::support_at_points ? wrenches_at_points() : of(Operand::jacobian);
    const ConstraintPaths& paths = kernel_.paths;
    MatrixXd J = MatrixXd::Zero(wrenches.rows(), joint.cols());
    for (std::size_t c = 0; c + 1 < paths.first.size(); ++c)
      for (int i = paths.begin[c]; i < paths.begin[c + 1]; ++i) {
        const int first = paths.first[c], count = paths.first[c + 1] - first, k = paths.path[static_cast<std::size_t>(i)];
        J.block(first, k, count, 1) = wrenches.middleRows(first, count).leftCols(6) * joint.col(k);
      }
    return J;
  }

  // J and M's U: as they are, or of V and J of articulated bodies and the rows' wrenches.
  std::pair<MatrixXd, MatrixXd> rows_and_factor() {
    if (!kernel_.by_limbs()) return {rows(), with_ones(of(Operand::factor))};
    const MatrixXd &gain = of(Operand::gain), &joint = of(Operand::joint);
    MatrixXd upper = MatrixXd::Identity(gain.cols(), gain.cols());
    for (Index k = 0; k < gain.cols(); ++k)
      for (int i = above_[static_cast<std::size_t>(k)]; i >= 0; i = above_[static_cast<std::size_t>(i)])
        upper(i, k) = gain.col(k).dot(joint.col(i));
    return {rows_along(joint), upper};
  }

  // J of rows that act, and M's U.
  std::pair<MatrixXd, MatrixXd> acting_rows_and_factor() {
    auto [J, upper] = rows_and_factor();
    return {acts().asDiagonal() * J, upper};
  }

  // By how much J M^-1 J' of rows that act is more on its diagonal in proximal steps.
  VectorXd held_by(const MatrixXd& along) const {
    const ConstraintPaths& paths = kernel_.paths;
    VectorXd held(along.rows());
    for (std::size_t c = 0; c + 1 < paths.first.size(); ++c) {
      const int first = paths.first[c], middle = first + paths.linear[c], behind = paths.first[c + 1];
      for (const auto& [begin, end] : {std::pair(first, middle), std::pair(middle, behind)}) {
        if (begin == end) continue;
        const double mean = along.diagonal().segment(begin, end - begin).mean() + 1e-6 * along.trace();
        for (int r = begin; r < end; ++r) held[r] = (along(r, r) > 0 ? 1e-8 : 1.0) * (mean > 0 ? mean : 1);
      }
    }
    return held.cwiseProduct(acts());
  }

  // What along f = right comes to by proximal steps, `more` being what gives way.
  MatrixXd proximal(const MatrixXd& along, const VectorXd& held, const VectorXd& more, const MatrixXd& right) const {
    const Eigen::LDLT<MatrixXd> factors(along + MatrixXd((held + more).asDiagonal()));
    MatrixXd f = MatrixXd::Zero(along.rows(), right.cols());
    for (int step = 0; step < kernel_.solutions; ++step) f = factors.solve(right + held.asDiagonal() * f).eval();
    return f;
  }
  // The same of the constraints' rows: none on those that do not act.
  MatrixXd forces(const MatrixXd& along, const MatrixXd& right) const {
    const VectorXd acts = this->acts();
    VectorXd more = VectorXd::Ones(acts.size()) - acts;
    if (acting_.regularization.size() > 0) more += acts.cwiseProduct(acting_.regularization);
    return proximal(along, held_by(along), more, acts.asDiagonal() * right);
  }

  void delassus() {
    const auto [J, upper] = rows_and_factor();
    of(Operand::to) = J * product(upper, of(Operand::pivots).col(0)).inverse() * J.transpose();
  }

  void solve_constrained() {
    const auto [J, upper] = acting_rows_and_factor();
    const VectorXd pivots = of(Operand::pivots).col(0);
    const MatrixXd inverse = product(upper, pivots).inverse(), along = J * inverse * J.transpose();
    if (kernel_.by_limbs()) of(Operand::to) = upper * pivots.asDiagonal() * of(Operand::to);
    const VectorXd free = inverse * of(Operand::to);
    of(Operand::forces) = forces(along, of(Operand::right) - J * free);
    of(Operand::to) = free + inverse * J.transpose() * of(Operand::forces);
  }

  void impact() {
    const auto [J, upper] = acting_rows_and_factor();
    const MatrixXd inverse = product(upper, of(Operand::pivots).col(0)).inverse(), along = J * inverse * J.transpose();
    of(Operand::forces) = forces(along, of(Operand::right));
    of(Operand::to) += inverse * J.transpose() * of(Operand::forces);
  }

  void support() {
    MatrixXd J;
    if (!kernel_.by_wrenches()) {
      J = of(Operand::jacobian);
    } else {
      MatrixXd joint = MatrixXd::Zero(6, of(Operand::to).rows());
      joint.leftCols(6).setIdentity();
      Index column = 0;
      for (const int k : kernel_.paths.moving())
        if (k >= 6) joint.col(k) = of(Operand::axes).col(column++);
      J = rows_along(joint);
    }
    J = J.unaryExpr([](double x) { return std::abs(x) <= 0x1p-46 ? 0.0 : x; }).eval();  // what is rounding holds nothing
    const auto count = static_cast<Index>(kernel_.undriven.size());
    MatrixXd own(J.rows(), count);
    VectorXd lacking(count);
    for (Index i = 0; i < count; ++i) {
      own.col(i) = J.col(kernel_.undriven[static_cast<std::size_t>(i)]);
      lacking[i] = of(Operand::to)(kernel_.undriven[static_cast<std::size_t>(i)], 0);
    }
    of(Operand::forces).setZero();
    if (count == 0) return;
    VectorXd weights = acts();
    if (acting_.weights.size() > 0) weights = weights.cwiseProduct(acting_.weights).eval();
    const MatrixXd along = own.transpose() * weights.asDiagonal() * own;
    VectorXd held = along.diagonal();
    for (Index i = 0; i < kernel_.base_undriven; i += 3) held.segment(i, 3).setConstant(held.segment(i, 3).mean());
    held = 1e-8 * held.unaryExpr([](double x) { return x > 0 ? x : 1.0; });
    of(Operand::forces) = weights.asDiagonal() * own * proximal(along, held, VectorXd::Zero(count), lacking);
    of(Operand::to) -= J.transpose() * of(Operand::forces);
  }

  void respond() {
    const MatrixXd J = acts().asDiagonal() * rows(), M = without_room(of(Operand::inverse), J.cols()),
                   along = J * M * J.transpose();
    const MatrixXd L = forces(along, MatrixXd::Identity(J.rows(), J.rows()));
    const MatrixXd B = M * J.transpose() * L;
    of(Operand::response).resize(J.cols() + J.rows(), J.rows());
    of(Operand::response) << B, L;
    of(Operand::to) = M - B * J * M;
    if (has(Operand::plain)) of(Operand::plain) = of(Operand::to);
    if (has(Operand::forces)) of(Operand::forces) = -B.transpose();
  }

  void derive() {
    const MatrixXd &changes = of(Operand::changes), &response = of(Operand::response);
    const MatrixXd B = response.topRows(changes.cols()), L = response.bottomRows(changes.rows());
    MatrixXd efforts = of(Operand::efforts);
    if (has(Operand::turned)) {
      const MatrixXd more = of(Operand::left).transpose() * of(Operand::turned);
      efforts += more;
      if (has(Operand::to)) of(Operand::to) -= of(Operand::inverse) * more;
    }
    if (has(Operand::to)) of(Operand::to) -= B * changes;
    if (has(Operand::forces)) of(Operand::forces) = B.transpose() * efforts - L * changes;
  }

  const Algorithm& algorithm_;
  Arrays& arrays_;
  const std::vector<int>& above_;
  const Acting& acting_;
  const Kernel& kernel_;
};

}  // namespace

void run_kernels(const Algorithm& algorithm, Arrays& arrays, const std::vector<int>& above, const Acting& acting) {
  for (const Kernel& kernel : algorithm.kernels) KernelRun(algorithm, arrays, above, acting, kernel).run();
  if (!algorithm.guard) return;
  // A section goes by what one before has found.
  if (algorithm.guard->pivots >= 0)
    arrays["status"] = MatrixXd::Constant(1, 1, guard_status(algorithm, arrays, above).coordinate);
  if (const auto status = arrays.find("status"); status == arrays.end() || status->second(0, 0) < 0) return;
  for (const int index : algorithm.guard->arrays) arrays[algorithm.arrays[static_cast<std::size_t>(index)].name].setZero();
}

}  // namespace dalembert::ir
