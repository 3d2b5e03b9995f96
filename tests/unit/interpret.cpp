#include "interpret.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "interpret_kernels.hpp"
#include "ir/coordinate_tree.hpp"
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
      case Op::sign: v = at(n.a) > Scalar(0) ? Scalar(1) : at(n.a) < Scalar(0) ? Scalar(-1) : at(n.a); break;
      case Op::negate: v = -at(n.a); break;
      case Op::add: v = at(n.a) + at(n.b); break;
      case Op::subtract: v = at(n.a) - at(n.b); break;
      case Op::multiply: v = at(n.a) * at(n.b); break;
      case Op::divide: v = at(n.a) / at(n.b); break;
      case Op::where: v = at(n.a) > Scalar(0) ? at(n.b) : Scalar(0); break;
    }
  }
  return value;
}

// What straight lines leave to lanes of rows.
void run_projections(const Algorithm& algorithm, Arrays& arrays) {
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
    for (const ProjectedBody& body : p.by_rows)
      for (const RowRun& run : body.runs)
        for (int i = 0; i < run.count; ++i) {
          const std::vector<double> values = interpret<double>(p.graph, [&](const Input& in) {
            return in.kind == InputKind::state ? array(p.bodies)(place(bodies, in), body.body)
                                               : array(p.joints)(run.joint + i, place(joints, in));
          });
          for (int c = 0; c < columns; ++c) {
            double& to = array(p.array)(run.row + i, body.column + c);
            to = (run.adds ? to : 0) + values[static_cast<std::size_t>(p.columns[static_cast<std::size_t>(c)])];
          }
        }
  }
}

// The rolled form, stage by stage as the emitted code runs it. What is kept is spoilt beforehand: nothing of an earlier
// evaluation may be read, but for what a new workspace has as zero.
class RolledRun {
 public:
  RolledRun(const Algorithm& algorithm, const RolledProgram& program, const Plan& plan, const KinematicTree& tree,
            bool rates_zero, FunctionInput input, const Acting& acting)
      : algorithm_(algorithm),
        program_(program),
        plan_(plan),
        tree_(tree),
        rates_zero_(rates_zero),
        input_(std::move(input)),
        acting_(acting),
        coordinates_(tree.coordinates()) {
    for (const KeptArray& a : program.arrays) kept_.push_back(Eigen::MatrixXd::Zero(a.components, plan.slots + 8));
  }

  Arrays run(Arrays arrays = {}) {
    arrays_ = std::move(arrays);
    for (const OutputArray& a : algorithm_.own_arrays())
      if (!a.written_out) arrays_[a.name] = Eigen::MatrixXd::Zero(a.rows, a.columns);
    joints();
    const int segments = static_cast<int>(plan_.segments.size());
    for (int level = 0; level < program_.levels(); ++level) {
      for (const BaseStage& b : program_.base)
        if (b.level == level) base(b);
      for (int i = 0; i < segments; ++i) segment(level % 2 == 0 ? i : segments - 1 - i, level);
    }
    results();
    run_kernels(algorithm_, arrays_, coordinate_tree(tree_).above, acting_);
    return arrays_;
  }

 private:
  // What has no place nobody may need: not a number.
  double& kept(int role, int component, int slot) {
    const Place p = role == Address::unknown ? Place{} : program_.places.at(static_cast<std::size_t>(role));
    if (p.array < 0) return nowhere_ = std::nan("");
    return kept_[static_cast<std::size_t>(p.array)](p.from + component, slot);
  }
  // own: the slot at which a loop is.
  double& kept(const Address& a, int own = -1) {
    return kept(a.role, a.component, a.body == Address::own ? own : slot(a.body));
  }
  int slot(int body) const { return plan_.slot(body); }

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
    const std::vector<double> values = interpret<double>(
        b.graph, [&](const Input& in) { return in.kind == InputKind::kept ? kept(address(in)) : input_(in); });
    for (const auto& [to, node] : b.stores) kept(to) = values[static_cast<std::size_t>(node)];
    for (const BlockElement& e : b.elements)
      arrays_[algorithm_.arrays[static_cast<std::size_t>(e.array)].name](e.row, e.column) =
          values[static_cast<std::size_t>(e.node)];
  }

  void segment(int number, int level) {
    const SegmentCode& code = program_.segments[static_cast<std::size_t>(number)];
    for (const SegmentStage& stage : code.stages)
      for (const Paragraph& p : stage.paragraphs) {
        if (stage.level != level) continue;
        OfLanes carried;
        const SlotLoop& loop = p.loop;
        for (const Carried& c : p.carried)
          for (int lane = 0; lane < loop.width; ++lane) {
            const auto at = static_cast<std::size_t>(lane);
            const double start = loop.direction == Direction::inwards ? 0
                                 : c.known()                          ? *c.initial[at]
                                                                      : kept(c.from.size() == 1 ? c.from.front() : c.from[at]);
            carried[{c.role, c.component}].push_back(start);
          }
        for (const LimbStep& step : p.written) take(step, p, code, carried);
        for (int i = 0; i < loop.steps && p.written.empty(); ++i) {
          const int first = loop.step(i) * loop.width;  // of the segment's slots
          std::vector<std::vector<double>> values;
          for (int lane = 0; lane < loop.width; ++lane) {
            const int here = loop.first_slot + first + lane;
            values.push_back(interpret<double>(p.graph, [&](const Input& in) {
              switch (in.kind) {
                case InputKind::table:
                  return code.columns[static_cast<std::size_t>(in.index)].values[static_cast<std::size_t>(first + lane)];
                case InputKind::kept: return kept(address(in), here);
                case InputKind::carried: {
                  const auto at = carried.find({in.index, in.component});
                  return at == carried.end() ? std::nan("") : at->second[static_cast<std::size_t>(lane)];
                }
                default: return input_(in);
              }
            }));
          }
          for (int lane = 0; lane < loop.width; ++lane) {
            const auto at = static_cast<std::size_t>(lane);
            for (const auto& [to, node] : p.stores)
              kept(to, loop.first_slot + first + lane) =
                  is_live(p, lane) ? values[at][static_cast<std::size_t>(node)] : std::nan("");
            for (const Carried& c : p.carried)
              carried[{c.role, c.component}][at] = values[at][static_cast<std::size_t>(c.node)];
          }
        }
        for (const HandedOn& h : p.handed) {
          double sum = 0;
          for (int lane : h.lanes) sum += carried.at({h.role, h.component})[static_cast<std::size_t>(lane)];
          double& to = kept(h.to);
          to = h.first ? sum : to + sum;
        }
      }
  }

  using OfLanes = std::map<std::pair<int, int>, std::vector<double>>;

  // What others would leave nobody may need.
  static bool is_live(const Paragraph& p, int lane) {
    return std::find(p.live_lanes.begin(), p.live_lanes.end(), lane) != p.live_lanes.end();
  }

  // What one step that is written out does.
  void take(const LimbStep& step, const Paragraph& p, const SegmentCode& code, OfLanes& carried) {
    const SlotLoop& loop = p.loop;
    std::vector<std::vector<double>> values;
    const auto slot = [&](int lane) { return loop.first_slot + step.place * loop.width + lane; };
    for (int lane = 0; lane < loop.width; ++lane)
      values.push_back(interpret<double>(step.graph, [&](const Input& in) {
        const auto at = static_cast<std::size_t>(lane);
        switch (in.kind) {
          case InputKind::table:
            return code.columns[static_cast<std::size_t>(in.index)]
                .values[static_cast<std::size_t>(step.place * loop.width) + at];
          case InputKind::kept: return kept(address(in), slot(lane));
          case InputKind::carried: return carried.at({in.index, in.component})[at];
          default: return input_(in);
        }
      }));
    for (int lane = 0; lane < loop.width; ++lane) {
      const auto at = static_cast<std::size_t>(lane);
      const auto value = [&](NodeId node) { return values[at][static_cast<std::size_t>(node)]; };
      for (const auto& [to, node] : step.stores) kept(to, slot(lane)) = is_live(p, lane) ? value(node) : std::nan("");
      for (const Carried& c : step.carried) carried.at({c.role, c.component})[at] = value(c.node);
    }
  }

  // Where blocks find a joint of the limb above a lane.
  int slot_above(const Segment& segment, const BlocksAbove& above, std::size_t lane, int r) const {
    const LimbRows& limb = above.limbs[lane];
    if (segment.limb_after_limb) return limb.slot + r * limb.stride;
    switch (above.where) {
      case BlocksAbove::Where::one: return above.one.slot + r * above.one.stride;
      case BlocksAbove::Where::lanes: {
        const Segment& other = plan_.segments[static_cast<std::size_t>(above.segment)];
        return other.first_slot + r * other.width + above.lanes[lane];
      }
      case BlocksAbove::Where::slots: break;
    }
    return above.slots_of[static_cast<std::size_t>(r) * above.limbs.size() + lane];
  }

  // Matrices of pairs, block by block as they are laid out. Where joints follow others, their rows and columns stand apart
  // until all are there.
  void elements(const PairBlocks& group, const ElementSums& sums) {
    Eigen::MatrixXd& m = of_array(algorithm_.pairs[static_cast<std::size_t>(sums.pairs)].array);
    const RolledPairs& base = program_.pairs[static_cast<std::size_t>(sums.pairs)];
    const std::vector<int>& row = group.following.row;
    const int rows = static_cast<int>(row.size()), following = tree_.joints() - tree_.independent_joints();
    std::vector<double> apart(static_cast<std::size_t>(2 * following * rows), std::nan(""));
    const auto put = [&](int i, int k, double value) {
      const auto of = [&](int at) { return row[static_cast<std::size_t>(at)]; };
      if (row.empty()) m(i, k) = value;
      else if (of(k) < 0) apart[static_cast<std::size_t>((-1 - of(k)) * rows + i)] = value;
      else if (of(i) < 0) apart[static_cast<std::size_t>((following - 1 - of(i)) * rows + k)] = value;
      else m(of(i), of(k)) = value;
    };
    const auto dot = [&](const std::vector<FactorTerm>& terms, int lower_slot, int upper_slot) {
      double sum = 0;
      for (const FactorTerm& t : terms) {
        const PairFactor lower = group.lower[static_cast<std::size_t>(t.lower)],
                         upper = group.upper[static_cast<std::size_t>(t.upper)];
        for (int i = 0; i < 3; ++i)
          sum += kept(lower.role, lower.from + i, lower_slot) * kept(upper.role, upper.from + i, upper_slot);
      }
      return sum;
    };
    for (std::size_t s = 0; s < group.segments.size(); ++s) {
      const SegmentBlocks& blocks = group.segments[s];
      for (std::size_t lane = 0; lane < blocks.limbs.size(); ++lane)
        for (int c = 0; c < blocks.limbs[lane].joints(); ++c) {
          const LimbRows& limb = blocks.limbs[lane];
          const int column = limb.row + c, here = limb.slot + c * limb.stride;
          const auto element = [&](int at, int there) {
            const double above = dot(sums.above, here, there);
            put(at, column, above);
            if (at == column) return;
            if (sums.symmetric) put(column, at, above);
            if (!sums.below.empty()) put(column, at, dot(sums.below, here, there));
          };
          for (int r = 0; r <= c; ++r) element(limb.row + r, limb.slot + r * limb.stride);
          for (const BlocksAbove& above : blocks.above)
            for (int r = 0; r < above.limbs[lane].joints(); ++r)
              element(above.limbs[lane].row + r, slot_above(plan_.segments[s], above, lane, r));
          for (int j = 0; j < 6 && base.columns >= 0; ++j) {
            put(j, column, kept(base.columns, j, here));
            if (base.rows >= 0) put(column, j, kept(base.rows, j, here));
          }
        }
    }
    for (std::size_t e = 0; e < group.following.to.size(); ++e) {
      double& to = m.data()[group.following.to[e]];
      to = (static_cast<int>(e) < group.following.set ? 0 : to) + apart[static_cast<std::size_t>(group.following.from[e])];
    }
  }

  // In lanes along rows; the base's one by one.
  void project(const Projection& p, const RolledProjection& rolled) {
    Eigen::MatrixXd& to = of_array(p.array);
    for (const ProjectedBody& body : rolled.bodies) {
      const auto of_body = [&](const Input& in) { return kept(in.index, in.component, slot(body.body)); };
      for (const RowRun& run : body.runs)
        for (int i = 0; i < run.count; ++i) {
          const std::vector<double> values = interpret<double>(p.graph, [&](const Input& in) {
            return in.kind == InputKind::state ? of_body(in) : kept(in.index, in.component, slot(run.joint + i));
          });
          for (std::size_t c = 0; c < p.columns.size(); ++c) {
            double& element = to(run.row + i, body.column + static_cast<int>(c));
            element = (run.adds ? element : 0) + values[static_cast<std::size_t>(p.columns[c])];
          }
        }
      const std::vector<double> values = interpret<double>(rolled.graph, of_body);
      for (const BlockElement& e : rolled.base) to(e.row, body.column + e.column) = values[static_cast<std::size_t>(e.node)];
    }
  }

  Eigen::MatrixXd& of_array(int array) { return arrays_[algorithm_.arrays[static_cast<std::size_t>(array)].name]; }

  void results() {
    for (const PairBlocks& group : program_.blocks)
      for (const ElementSums& sums : group.sums) elements(group, sums);
    for (const AddedConstant& a : program_.added)
      of_array(a.array)(a.row, a.column) += a.role < 0 ? a.value : a.value * kept(a.role, 0, slot(a.body));
    for (std::size_t p = 0; p < algorithm_.projections.size(); ++p) project(algorithm_.projections[p], program_.projections[p]);
    for (const JointResult& joints : program_.results) {
      const int array = algorithm_.results[static_cast<std::size_t>(joints.result)].array;
      double* const to = of_array(array).data();
      for (const auto& [at, from, first] : joints.elements) to[at] = (first ? 0 : to[at]) + kept(from);
    }
  }

  const Algorithm& algorithm_;
  const RolledProgram& program_;
  const Plan& plan_;
  const KinematicTree& tree_;
  const bool rates_zero_;
  const FunctionInput input_;
  const Acting acting_;
  const std::vector<int> coordinates_;
  std::vector<Eigen::MatrixXd> kept_;  // component, slot
  double nowhere_ = 0;
  Arrays arrays_;
};

}  // namespace

Arrays run(const Algorithm& algorithm, const Program& program, const KinematicTree& tree, const FunctionInput& input,
           Arrays arrays, const Acting& acting) {
  for (std::size_t i = algorithm.inherited; i < program.arrays.size(); ++i)
    if (const OutputArray& a = program.arrays[i]; !a.written_out) arrays[a.name] = Eigen::MatrixXd::Zero(a.rows, a.columns);
  const std::vector<double> values = interpret<double>(program.graph, input);
  for (const OutputElement& e : program.elements)
    arrays[program.arrays[static_cast<std::size_t>(e.array)].name](e.row, e.column) = values[static_cast<std::size_t>(e.node)];
  run_projections(algorithm, arrays);
  run_kernels(algorithm, arrays, coordinate_tree(tree).above, acting);
  return arrays;
}

Arrays run(const Algorithm& algorithm, const RolledProgram& program, const Plan& plan, const KinematicTree& tree,
           bool rates_zero, const FunctionInput& input, const Arrays& arrays, const Acting& acting) {
  RolledRun rolled(algorithm, program, plan, tree, rates_zero, input, acting);
  rolled.run(arrays);
  return rolled.run(arrays);
}

}  // namespace dalembert::ir
