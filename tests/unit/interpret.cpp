#include "interpret.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <dalembert/constraint_shapes.hpp>
#include <dalembert/pivots.hpp>
#include <map>
#include <string>
#include <vector>

#include "dalembert/chain_shapes.hpp"
#include "ir/coordinate_tree.hpp"
#include "ir/moved_links.hpp"
#include "ir/row_runs.hpp"
#include "ir/written_limb.hpp"
#include "passes/joints.hpp"

namespace dalembert::ir {
namespace {

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

// M = U D U' one coordinate after another, from the last: U and D in one matrix, and D alone.
void factor(Eigen::MatrixXd M, Eigen::MatrixXd& upper, Eigen::MatrixXd& pivots) {
  upper.setZero();
  for (Eigen::Index k = M.rows(); k-- > 0;) {
    upper(k, k) = pivots(k, 0) = M(k, k);
    upper.col(k).head(k) = M.col(k).head(k) / M(k, k);
    M.topLeftCorner(k, k) -= M(k, k) * upper.col(k).head(k) * upper.col(k).head(k).transpose();
  }
}

// What the guard of a function finds in its arrays, as dalembert/factor.hpp has it. above: the coordinate above each.
FactorStatus<double> guard_status(const Algorithm& algorithm, Arrays& arrays, const std::vector<int>& above) {
  const Guard& guard = *algorithm.guard;
  const auto array = [&](int index) -> Eigen::MatrixXd& {
    return arrays[algorithm.arrays[static_cast<std::size_t>(index)].name];
  };
  const Eigen::VectorXd pivots = array(guard.pivots), diagonal = array(guard.diagonal);
  if ((pivots.array() > detail::least_ratio<double>() * diagonal.array() && pivots.array() > 0).all()) return {};
  const Eigen::Index n = pivots.size();
  const double rounding = detail::rounding_left<double>(static_cast<int>(n));
  if (guard.factor >= 0) {
    Eigen::VectorXd x(n);
    return detail::bounded_status<double>(static_cast<int>(n), above.data(), array(guard.factor).data(), pivots.data(),
                                          diagonal.data(), x.data());
  }
  // E of every coordinate, as a matrix.
  const Eigen::MatrixXd &gain = array(guard.gain), &joint = array(guard.joint);
  std::vector<Eigen::MatrixXd> beyond(static_cast<std::size_t>(n), Eigen::MatrixXd::Zero(6, 6));
  for (Eigen::Index k = n; k-- > 0;) {
    const Eigen::MatrixXd& E = beyond[static_cast<std::size_t>(k)];
    const Eigen::VectorXd V = gain.col(k), J = joint.col(k);
    if (!detail::exceeds(pivots[k], diagonal[k] + std::max(0.0, J.dot(E * J)), rounding))
      return {static_cast<int>(k), pivots[k]};
    const Eigen::MatrixXd P = Eigen::MatrixXd::Identity(6, 6) - J * V.transpose();
    if (const int p = above[static_cast<std::size_t>(k)]; p >= 0)
      beyond[static_cast<std::size_t>(p)] += P.transpose() * E * P + diagonal[k] * V * V.transpose();
  }
  return {};
}

// M^-1 from its room: as straight lines leave it, or as it was made here.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& room, Eigen::Index n) {
  if (room.cols() > 1) return room;
  return Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>(room.data(), n, n,
                                                                    Eigen::OuterStride<>(inverse_stride(static_cast<int>(n))));
}

// J of rows, rounding being nothing.
Eigen::MatrixXd rows_of(const Eigen::MatrixXd& J) {
  return (J.array().abs() <= Proximal<double>::unmoved).select(Eigen::MatrixXd::Zero(J.rows(), J.cols()), J);
}

// J and M's U, above its diagonal: as they are,
std::pair<Eigen::MatrixXd, Eigen::MatrixXd> rows_and_factor(const Eigen::MatrixXd& J, const Eigen::MatrixXd& factor) {
  Eigen::MatrixXd upper = factor.triangularView<Eigen::StrictlyUpper>();
  upper.diagonal().setOnes();
  return {rows_of(J), upper};
}

// J of the rows' wrenches on the base and of the axes that coordinates move along, 6 x n.
Eigen::MatrixXd rows_along(const ConstraintStep& s, const Eigen::MatrixXd& wrenches, const Eigen::MatrixXd& joint) {
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(wrenches.rows(), joint.cols());
  for (std::size_t c = 0; c + 1 < s.paths.first.size(); ++c)
    for (int i = s.paths.begin[c]; i < s.paths.begin[c + 1]; ++i) {
      const int first = s.paths.first[c], rows = s.paths.first[c + 1] - first, k = s.paths.path[static_cast<std::size_t>(i)];
      J.block(first, k, rows, 1) = wrenches.middleRows(first, rows).leftCols(6) * joint.col(k);
    }
  return J;
}

// J and U of V and J of articulated bodies and the rows' wrenches.
std::pair<Eigen::MatrixXd, Eigen::MatrixXd> rows_and_factor_of_limbs(const ConstraintStep& s, const Eigen::MatrixXd& wrenches,
                                                                     const Eigen::MatrixXd& gain, const Eigen::MatrixXd& joint,
                                                                     const std::vector<int>& above) {
  const Eigen::Index n = gain.cols();
  Eigen::MatrixXd upper = Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index k = 0; k < n; ++k)
    for (int i = above[static_cast<std::size_t>(k)]; i >= 0; i = above[static_cast<std::size_t>(i)])
      upper(i, k) = gain.col(k).dot(joint.col(i));
  return {rows_along(s, wrenches, joint), upper};
}

// J of the rows' wrenches and of the axes of the joints above constraints alone.
Eigen::MatrixXd rows_by_wrenches(const ConstraintStep& s, const Eigen::MatrixXd& wrenches, const Eigen::MatrixXd& axes,
                                 Eigen::Index n) {
  Eigen::MatrixXd joint = Eigen::MatrixXd::Zero(6, n);
  joint.leftCols(6).setIdentity();
  Eigen::Index column = 0;
  for (const int k : s.paths.moving())
    if (k >= 6) joint.col(k) = axes.col(column++);
  return rows_along(s, wrenches, joint);
}

// Steps with rows of constraints, likewise: all act, nothing gives way.
void run_constraint_steps(const Algorithm& algorithm, Arrays& arrays, const std::vector<int>& above) {
  for (const ConstraintStep& s : algorithm.steps_of<ConstraintStep>()) {
    const auto array = [&](int index) -> Eigen::MatrixXd& {
      return arrays[algorithm.arrays[static_cast<std::size_t>(index)].name];
    };
    if (s.kind == ConstraintStep::Kind::support) {
      Eigen::MatrixXd J = array(s.jacobian);
      if (s.by_wrenches()) J = rows_by_wrenches(s, J, array(s.axes), array(s.to).rows());
      const auto count = static_cast<Eigen::Index>(s.undriven.size());
      Eigen::MatrixXd own(J.rows(), count);
      Eigen::VectorXd lacking(count), y = Eigen::VectorXd::Zero(count);
      for (Eigen::Index i = 0; i < count; ++i) {
        own.col(i) = J.col(s.undriven[static_cast<std::size_t>(i)]);
        lacking[i] = array(s.to)(s.undriven[static_cast<std::size_t>(i)], 0);
      }
      array(s.forces).setZero();
      if (count == 0) continue;
      const Eigen::MatrixXd along = own.transpose() * own;
      const Eigen::VectorXd held = 1e-8 * along.diagonal().unaryExpr([](double x) { return x > 0 ? x : 1.0; });
      const Eigen::LDLT<Eigen::MatrixXd> factors(along + Eigen::MatrixXd(held.asDiagonal()));
      for (int step = 0; step < s.solutions; ++step) y = factors.solve(lacking + held.cwiseProduct(y)).eval();
      array(s.forces) = own * y;
      array(s.to) -= J.transpose() * array(s.forces);
      continue;
    }
    const auto held_by = [&](const Eigen::MatrixXd& along) {
      Eigen::VectorXd held(along.rows());
      for (std::size_t c = 0; c + 1 < s.paths.first.size(); ++c) {
        const int first = s.paths.first[c], middle = first + s.paths.linear[c], behind = s.paths.first[c + 1];
        for (const auto& [begin, end] : {std::pair(first, middle), std::pair(middle, behind)}) {
          if (begin == end) continue;
          const double mean = along.diagonal().segment(begin, end - begin).mean() + 1e-6 * along.trace();
          for (int r = begin; r < end; ++r) held[r] = (along(r, r) > 0 ? 1e-8 : 1.0) * (mean > 0 ? mean : 1);
        }
      }
      return held;
    };
    if (s.kind == ConstraintStep::Kind::respond) {
      const Eigen::MatrixXd J = rows_of(array(s.jacobian));
      const Eigen::MatrixXd M = inverse(array(s.inverse), J.cols()), along = J * M * J.transpose();
      const Eigen::VectorXd held = held_by(along);
      const Eigen::LDLT<Eigen::MatrixXd> factors(along + Eigen::MatrixXd(held.asDiagonal()));
      const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(J.rows(), J.rows());
      Eigen::MatrixXd L = Eigen::MatrixXd::Zero(J.rows(), J.rows());
      for (int step = 0; step < s.solutions; ++step) L = factors.solve(one + held.asDiagonal() * L).eval();
      // B, and L beneath.
      array(s.room).resize(J.cols() + J.rows(), J.rows());
      array(s.room) << M * J.transpose() * L, L;
      array(s.to) = M - M * J.transpose() * L * J * M;
      if (s.plain >= 0) array(s.plain) = array(s.to);
      if (s.forces >= 0) array(s.forces) = -(M * J.transpose() * L).transpose();
      continue;
    }
    if (s.kind == ConstraintStep::Kind::derive) {
      const Eigen::MatrixXd &changes = array(s.changes), &room = array(s.room);
      const Eigen::MatrixXd B = room.topRows(changes.cols()), L = room.bottomRows(changes.rows());
      Eigen::MatrixXd efforts = array(s.efforts);
      if (s.turning_rows > 0) {
        const Eigen::MatrixXd more = array(s.left).transpose() * array(s.turned);
        efforts += more;
        if (s.to >= 0) array(s.to) -= array(s.inverse) * more;
      }
      if (s.to >= 0) array(s.to) -= B * changes;
      if (s.forces >= 0) array(s.forces) = B.transpose() * efforts - L * changes;
      continue;
    }
    const auto [J, upper] = s.by_limbs() ? rows_and_factor_of_limbs(s, array(s.jacobian), array(s.gain), array(s.joint), above)
                                         : rows_and_factor(array(s.jacobian), array(s.factor));
    const Eigen::MatrixXd inverse = (upper * array(s.pivots).col(0).asDiagonal() * upper.transpose()).inverse();
    Eigen::MatrixXd along = J * inverse * J.transpose();
    if (s.kind == ConstraintStep::Kind::delassus) {
      array(s.to) = along;
      continue;
    }
    const bool impact = s.kind == ConstraintStep::Kind::impact;
    if (!impact && s.by_limbs()) array(s.to) = upper * array(s.pivots).col(0).asDiagonal() * array(s.to);
    const Eigen::VectorXd free = impact ? Eigen::VectorXd::Zero(J.cols()) : Eigen::VectorXd(inverse * array(s.to)),
                          rest = array(s.right) - J * free;
    const Eigen::VectorXd held = held_by(along);
    Eigen::VectorXd forces = Eigen::VectorXd::Zero(J.rows());
    along.diagonal() += held;
    const Eigen::LDLT<Eigen::MatrixXd> factors(along);
    for (int step = 0; step < s.solutions; ++step) forces = factors.solve(rest + held.cwiseProduct(forces)).eval();
    array(s.forces) = forces;
    array(s.to) = (impact ? Eigen::VectorXd(array(s.to)) : free) + inverse * J.transpose() * forces;
  }
}

// Steps with whole matrices, in the terms of their definition.
void run_steps(const Algorithm& algorithm, Arrays& arrays, const std::vector<int>& above) {
  const auto array = [&](int index) -> Eigen::MatrixXd& {
    return arrays[algorithm.arrays[static_cast<std::size_t>(index)].name];
  };
  for (const MatrixStep& s : algorithm.steps_of<MatrixStep>()) {
    if (s.kind == MatrixStep::Kind::negative_product) {
      const Eigen::Index from = s.first, count = array(s.b).cols() - from;
      array(s.to).rightCols(count) = -inverse(array(s.a), array(s.b).rows()) * array(s.b).rightCols(count);
      continue;
    }
    if (s.kind == MatrixStep::Kind::factor) {
      factor(array(s.a), array(s.to), array(s.b));
      array(algorithm.guard->diagonal) = array(s.a).diagonal();
      continue;
    }
    if (s.kind == MatrixStep::Kind::solve) {
      Eigen::MatrixXd upper = array(s.a);
      const Eigen::VectorXd pivots = upper.diagonal();
      upper.diagonal().setOnes();
      array(s.to) = (upper * pivots.asDiagonal() * upper.transpose()).inverse() * array(s.to);
      continue;
    }
    Eigen::MatrixXd transposed = array(s.a).triangularView<Eigen::StrictlyUpper>();
    transposed.diagonal().setOnes();
    array(s.to) = array(s.room) = (transposed * array(s.b).col(0).asDiagonal() * transposed.transpose()).inverse();
  }
  run_constraint_steps(algorithm, arrays, above);
  if (!algorithm.guard) return;
  // A section goes by what one before has found.
  if (algorithm.guard->pivots >= 0)
    arrays["status"] = Eigen::MatrixXd::Constant(1, 1, guard_status(algorithm, arrays, above).coordinate);
  if (const auto status = arrays.find("status"); status == arrays.end() || status->second(0, 0) < 0) return;
  for (const int index : algorithm.guard->arrays) array(index).setZero();
}

// What straight lines leave to lanes of rows.
void run_projections(const Algorithm& algorithm, const KinematicTree& tree, Arrays& arrays) {
  const auto array = [&](int index) -> Eigen::MatrixXd& {
    return arrays[algorithm.arrays[static_cast<std::size_t>(index)].name];
  };
  for (const Projection& p : algorithm.projections) {
    if (p.bodies < 0) continue;
    const std::vector<Input> bodies = p.inputs(InputKind::state), joints = p.inputs(InputKind::carried);
    const auto place = [](const std::vector<Input>& inputs, const Input& in) {
      return std::find(inputs.begin(), inputs.end(), in) - inputs.begin();
    };
    const int columns = static_cast<int>(p.columns.size());
    const std::vector<int> links = numbers_of_links(tree);
    for (int body = 0; body < tree.joints(); ++body) {
      if (links[static_cast<std::size_t>(body)] < 0 || !by_rows(tree, body)) continue;
      for (const RowRun& run : row_runs(tree, body))
        for (int i = 0; i < run.count; ++i) {
          const std::vector<double> values = interpret<double>(p.graph, [&](const Input& in) {
            return in.kind == InputKind::state ? array(p.bodies)(place(bodies, in), body)
                                               : array(p.joints)(run.joint + i, place(joints, in));
          });
          for (int c = 0; c < columns; ++c) {
            double& to = array(p.array)(run.row + i, columns * links[static_cast<std::size_t>(body)] + c);
            to = (run.adds ? to : 0) + values[static_cast<std::size_t>(p.columns[static_cast<std::size_t>(c)])];
          }
        }
    }
  }
}

// The rolled form, stage by stage as the emitted code runs it. What is kept is spoilt beforehand: nothing of an earlier
// evaluation may be read, but for what a new workspace has as zero.
class RolledRun {
 public:
  RolledRun(const Algorithm& algorithm, const RolledProgram& program, const Plan& plan, const KinematicTree& tree,
            bool rates_zero, FunctionInput input)
      : algorithm_(algorithm),
        program_(program),
        plan_(plan),
        tree_(tree),
        rates_zero_(rates_zero),
        input_(std::move(input)),
        coordinates_(tree.coordinates()) {
    for (const KeptArray& a : program.arrays) kept_.push_back(Eigen::MatrixXd::Zero(a.components, plan.slots + 8));
  }

  Arrays run(Arrays arrays = {}) {
    arrays_ = std::move(arrays);
    for (const OutputArray& a : algorithm_.own_arrays())
      if (!a.written_out) arrays_[a.name] = Eigen::MatrixXd::Zero(a.rows, a.columns);
    joints();
    int levels = 0;
    for (const SegmentCode& s : program_.segments)
      for (const SegmentStage& stage : s.stages) levels = std::max(levels, stage.level);
    for (const BaseStage& b : program_.base) levels = std::max(levels, b.level);
    const int segments = static_cast<int>(plan_.segments.size());
    for (int level = 0; level <= levels; ++level) {
      for (const BaseStage& b : program_.base)
        if (b.level == level) base(b);
      for (int i = 0; i < segments; ++i) segment(level % 2 == 0 ? i : segments - 1 - i, level);
    }
    results();
    run_steps(algorithm_, arrays_, coordinate_tree(tree_).above);
    return arrays_;
  }

 private:
  // What has no place nobody may need: not a number.
  double& place(const Place& p, int component, int slot) {
    if (p.array < 0) return nowhere_ = std::nan("");
    return kept_[static_cast<std::size_t>(p.array)](p.from + component, slot);
  }
  double& kept(int role, int component, int slot) {
    return place(program_.places.at(static_cast<std::size_t>(role)), component, slot);
  }
  double& received(int role, int component, int slot) {
    return place(program_.received.at(static_cast<std::size_t>(role)), component, slot);
  }
  int slot(int body) const { return body < 0 ? plan_.root_slot : plan_.slot_of[static_cast<std::size_t>(body)]; }
  int row(int body) const { return tree_.base_coordinates() + coordinates_[static_cast<std::size_t>(body)]; }

  void joints() {
    for (std::size_t r = 0; r < program_.roles.size(); ++r) {
      if (program_.roles[r].source == Source::sweep || program_.places[r].array < 0) continue;
      // Places without a body have some other joint's position and rate, as the emitted code gathers it.
      if (program_.roles[r].source == Source::rate || program_.roles[r].source == Source::position)
        for (int s = 0; s < plan_.slots; ++s) kept(static_cast<int>(r), 0, s) = 0.7;
      for (int k = 0; k < tree_.joints(); ++k) {
        Graph graph;
        const NodeId node =
            passes::coordinate_node(graph, program_.roles[r], tree_, coordinates_, tree_.positions(), rates_zero_, k);
        kept(static_cast<int>(r), 0, slot(k)) = interpret<double>(graph, input_)[static_cast<std::size_t>(node)];
      }
    }
  }

  void base(const BaseStage& b) {
    const std::vector<double> values = interpret<double>(b.graph, [&](const Input& in) {
      if (in.kind == InputKind::of_body) return kept(in.index, in.component, slot(in.body));
      if (in.kind == InputKind::received) return received(in.index, in.component, slot(-1));
      return input_(in);
    });
    for (const Value& v : b.stores) kept(v.role, v.component, slot(-1)) = values[static_cast<std::size_t>(v.node)];
    for (const BodyStore& v : b.body_stores) kept(v.role, v.component, slot(v.body)) = values[static_cast<std::size_t>(v.node)];
    for (const BlockElement& e : b.elements)
      arrays_[algorithm_.arrays[static_cast<std::size_t>(e.array)].name](e.row, e.column) =
          values[static_cast<std::size_t>(e.node)];
  }

  void segment(int number, int level) {
    const Segment& s = plan_.segments[static_cast<std::size_t>(number)];
    const SegmentCode& code = program_.segments[static_cast<std::size_t>(number)];
    for (const SegmentStage& stage : code.stages)
      for (const Paragraph& p : stage.paragraphs) {
        if (stage.level != level) continue;
        OfLanes carried;
        for (const Carried& c : p.carried)
          for (int lane = 0; lane < s.width; ++lane) {
            const auto at = static_cast<std::size_t>(lane);
            const double start = p.direction == Direction::inwards ? 0
                                 : c.known()                       ? *c.initial[at]
                                                                   : kept(c.role, c.component, slot(s.parents[at]));
            carried[{c.role, c.component}].push_back(start);
          }
        const std::vector<LimbStep> written = written_limb(plan_, program_, static_cast<std::size_t>(number), p);
        for (const LimbStep& step : written) take(step, carried);
        for (int i = 0; i < s.steps && written.empty(); ++i) {
          const int step = p.direction == Direction::inwards ? s.steps - 1 - i : i;
          std::vector<std::vector<double>> values;
          for (int lane = 0; lane < s.width; ++lane) {
            const int here = s.first_slot + step * s.width + lane;
            values.push_back(interpret<double>(p.graph, [&](const Input& in) {
              switch (in.kind) {
                case InputKind::table:
                  return code.columns[static_cast<std::size_t>(in.index)]
                      .values[static_cast<std::size_t>(step * s.width + lane)];
                case InputKind::state: return kept(in.index, in.component, here);
                case InputKind::received: return received(in.index, in.component, here);
                case InputKind::of_body: return kept(in.index, in.component, slot(in.body));
                case InputKind::carried: {
                  const auto at = carried.find({in.index, in.component});
                  return at == carried.end() ? std::nan("") : at->second[static_cast<std::size_t>(lane)];
                }
                default: return input_(in);
              }
            }));
          }
          for (int lane = 0; lane < s.width; ++lane) {
            const auto at = static_cast<std::size_t>(lane);
            for (const Value& v : p.stores)
              kept(v.role, v.component, s.first_slot + step * s.width + lane) = values[at][static_cast<std::size_t>(v.node)];
            for (const Carried& c : p.carried)
              carried[{c.role, c.component}][at] = values[at][static_cast<std::size_t>(c.node)];
          }
        }
        if (p.direction != Direction::inwards) continue;
        for (const HandedOn& h : code.handed) {
          const auto from = carried.find({h.role, h.component});
          if (h.level != level || from == carried.end()) continue;
          double sum = 0;
          for (int lane : h.lanes) sum += from->second[static_cast<std::size_t>(lane)];
          double& to = h.received ? received(h.role, h.component, slot(h.parent)) : kept(h.role, h.component, slot(h.parent));
          to = h.first ? sum : to + sum;
        }
      }
  }

  using OfLanes = std::map<std::pair<int, int>, std::vector<double>>;

  // What one body of a limb that is written out does.
  void take(const LimbStep& step, OfLanes& carried) {
    const std::vector<double> values = interpret<double>(step.graph, [&](const Input& in) {
      switch (in.kind) {
        case InputKind::received: return received(in.index, in.component, slot(in.body));
        case InputKind::of_body: return kept(in.index, in.component, slot(in.body));
        case InputKind::carried: return carried.at({in.index, in.component}).front();
        default: return input_(in);
      }
    });
    const auto value = [&](NodeId node) { return values[static_cast<std::size_t>(node)]; };
    for (const Value& v : step.stores) kept(v.role, v.component, slot(step.body)) = value(v.node);
    for (const Carried& c : step.carried) carried.at({c.role, c.component}).front() = value(c.node);
  }

  double dot(const std::vector<PairTerm>& terms, int lower, int upper) {
    double sum = 0;
    for (const PairTerm& t : terms)
      for (int i = 0; i < 3; ++i)
        sum += kept(t.lower, t.lower_from + i, slot(lower)) * kept(t.upper, t.upper_from + i, slot(upper));
    return sum;
  }

  void results() {
    for (std::size_t n = 0; n < algorithm_.pairs.size(); ++n) {
      const Pairs& p = algorithm_.pairs[n];
      Eigen::MatrixXd& m = arrays_[algorithm_.arrays[static_cast<std::size_t>(p.array)].name];
      const OutputArray& array = algorithm_.arrays[static_cast<std::size_t>(p.array)];
      for (int k = 0; k < tree_.joints(); ++k) {
        const int column = array.row(row(k));
        if (column < 0) continue;
        for (int i = k; i >= 0; i = tree_.bodies[static_cast<std::size_t>(i)].parent) {
          const int at = array.row(row(i));
          if (at < 0) continue;
          const double above = dot(p.above, k, i);
          m(at, column) += above;
          if (i == k) continue;
          if (p.symmetric) m(column, at) += above;
          if (!p.below.empty()) m(column, at) += dot(p.below, k, i);
        }
        for (int j = 0; j < 6 && program_.pairs[n].columns >= 0; ++j) {
          m(j, column) += kept(program_.pairs[n].columns, j, slot(k));
          if (program_.pairs[n].rows >= 0) m(column, j) += kept(program_.pairs[n].rows, j, slot(k));
        }
      }
    }
    for (const AddedConstant& a : program_.added)
      arrays_[algorithm_.arrays[static_cast<std::size_t>(a.array)].name](a.row, a.column) +=
          a.role < 0 ? a.value : a.value * kept(a.role, 0, slot(a.body));
    const std::vector<int> links = numbers_of_links(tree_);
    for (const Projection& p : algorithm_.projections)
      for (int body = 0; body < tree_.joints(); ++body) {
        if (links[static_cast<std::size_t>(body)] < 0) continue;
        const OutputArray& array = algorithm_.arrays[static_cast<std::size_t>(p.array)];
        const int columns = static_cast<int>(p.columns.size()),
                  first = array.column(columns * links[static_cast<std::size_t>(body)]);
        if (first < 0) continue;
        const auto project = [&](int of_whole, const std::function<double(const Input&)>& upper) {
          const int at = array.row(of_whole);
          if (at < 0) return;
          const std::vector<double> values = interpret<double>(p.graph, [&](const Input& in) {
            return in.kind == InputKind::state ? kept(in.index, in.component, slot(body)) : upper(in);
          });
          for (int c = 0; c < columns; ++c)
            arrays_[algorithm_.arrays[static_cast<std::size_t>(p.array)].name](at, first + c) +=
                values[static_cast<std::size_t>(p.columns[static_cast<std::size_t>(c)])];
        };
        for (int i = body; i >= 0; i = tree_.bodies[static_cast<std::size_t>(i)].parent)
          project(row(i), [&](const Input& in) { return kept(in.index, in.component, slot(i)); });
        for (int j = 0; j < tree_.base_coordinates(); ++j)
          project(j, [&](const Input& in) { return program_.base_coordinates.at({in.index, in.component, j}); });
      }
    for (const Result& r : algorithm_.results)
      for (int k = 0; k < tree_.joints() && r.layout != Layout::base; ++k)
        for (int i = 0; i < program_.roles[static_cast<std::size_t>(r.role)].components(); ++i) {
          if (!r.over.contains(tree_, k)) continue;
          const OutputArray& array = algorithm_.arrays[static_cast<std::size_t>(r.array)];
          Eigen::MatrixXd& m = arrays_[array.name];
          const int at = r.layout == Layout::columns ? array.column(row(k)) : array.row(row(k));
          if (at < 0) continue;
          if (r.layout == Layout::columns) m(r.from + i, at) += kept(r.role, i, slot(k));
          else m(at, 0) += kept(r.role, i, slot(k));
        }
  }

  const Algorithm& algorithm_;
  const RolledProgram& program_;
  const Plan& plan_;
  const KinematicTree& tree_;
  const bool rates_zero_;
  const FunctionInput input_;
  const std::vector<int> coordinates_;
  std::vector<Eigen::MatrixXd> kept_;  // component, slot
  double nowhere_ = 0;
  Arrays arrays_;
};

}  // namespace

Arrays run(const Algorithm& algorithm, const Program& program, const KinematicTree& tree, const FunctionInput& input,
           Arrays arrays) {
  for (std::size_t i = algorithm.inherited; i < program.arrays.size(); ++i)
    if (const OutputArray& a = program.arrays[i]; !a.written_out) arrays[a.name] = Eigen::MatrixXd::Zero(a.rows, a.columns);
  const std::vector<double> values = interpret<double>(program.graph, input);
  for (const OutputElement& e : program.elements)
    arrays[program.arrays[static_cast<std::size_t>(e.array)].name](e.row, e.column) = values[static_cast<std::size_t>(e.node)];
  run_projections(algorithm, tree, arrays);
  run_steps(algorithm, arrays, coordinate_tree(tree).above);
  return arrays;
}

Arrays run(const Algorithm& algorithm, const RolledProgram& program, const Plan& plan, const KinematicTree& tree,
           bool rates_zero, const FunctionInput& input, const Arrays& arrays) {
  RolledRun rolled(algorithm, program, plan, tree, rates_zero, input);
  rolled.run(arrays);
  return rolled.run(arrays);
}

}  // namespace dalembert::ir
