#include <algorithm>
#include <optional>

#include "passes/joints.hpp"
#include "passes/parameters.hpp"
#include "passes/roll_state.hpp"

namespace dalembert::passes {
namespace {

using ir::Direction;
using ir::InputKind;
using ir::no_node;
using ir::NodeId;
using ir::Paragraph;

class SegmentRoll {
 public:
  SegmentRoll(RollState& state, std::size_t number)
      : state_(state), number_(number), segment_(state.plan.segments[number]), code_(state.program.segments[number]) {}

  void run() {
    for (const RollStep& step : state_.steps) begin(step);
    code_.stages.resize(0);
    std::stable_sort(groups_.begin(), groups_.end(), [](const Group& a, const Group& b) { return a.level < b.level; });
    for (const Group& group : groups_) write(group);
  }

 private:
  // Steps of one loop.
  struct Group {
    int level = 0;
    Direction direction = Direction::anywhere;
    std::vector<RollStep> steps;
    long operations = 0;
    bool divides = false;
  };

  const ir::Sweep& sweep_of(const RollStep& s) const { return state_.algorithm.sweeps[static_cast<std::size_t>(s.sweep)]; }

  ir::Operations operations(const RollStep& s) const {
    if (s.sweep < 0) return {};
    const ir::Sweep& sweep = sweep_of(s);
    const Live& live = state_.unroll.live();
    std::vector<NodeId> roots;
    for (const ir::Value& v : sweep.stores)
      if (live.body[live.at(v.role, v.component)]) roots.push_back(v.node);
    return ir::count(sweep.graph, ir::uses(sweep.graph, roots));
  }

  // What runs anywhere joins the loop before it of the same level, but where lanes along the segment pay more, or where a body
  // would have more values at once than there are registers for.
  void begin(const RollStep& step) {
    const Direction direction = step.sweep < 0 ? Direction::anywhere : sweep_of(step).direction;
    if (step.sweep >= 0 && !any_body(sweep_of(step))) return;
    const ir::Operations count = operations(step);
    const long own = count.total();
    const bool divides = count.divide > 0;
    Group* last = nullptr;
    for (Group& g : groups_)
      if (g.level == step.level) last = &g;
    const bool along = segment_.width == 1 && segment_.steps > (all_operations() > 400 ? 1 : 4);
    const auto joins = [&] {
      if (!last) return false;
      if (step.sweep < 0) return true;  // products with what was just made
      if (last->direction == direction && direction == Direction::anywhere) return true;
      if (direction == Direction::anywhere) {
        constexpr long registers = 330;  // operations of a body that still fit
        return !along && (last->direction == Direction::inwards || last->operations + own <= registers);
      }
      constexpr long small = 8;  // not worth a loop of its own
      // Whoever waits for a division has time for other sums.
      const bool waits = direction == Direction::inwards && (last->divides || divides);
      return last->direction == direction && (waits || last->operations <= small);
    };
    if (joins()) {
      last->steps.push_back(step);
      last->operations += own;
      last->divides = last->divides || divides;
    } else {
      groups_.push_back({step.level, direction, {step}, own, divides});
    }
  }
  long all_operations() const {
    long total = 0;
    for (const RollStep& s : state_.steps) total += operations(s).total();
    return total;
  }

  bool any_body(const ir::Sweep& sweep) const {
    for (const std::vector<int>& limb : segment_.bodies)
      for (const int body : limb)
        if (body >= 0 && sweep.over.contains(state_.tree, body)) return true;
    return false;
  }

  int body(int lane, int step) const { return segment_.bodies[static_cast<std::size_t>(lane)][static_cast<std::size_t>(step)]; }

  static std::optional<double> zero_if(bool zero) { return zero ? std::optional(0.0) : std::nullopt; }

  // A number, or a column, where the value is constant at all bodies; `elsewhere`: what places without a body have, if not what
  // is at hand.
  template <class Of>
  std::optional<NodeId> constant(const std::string& name, const std::string& unit, std::optional<double> elsewhere,
                                 const Of& of) {
    std::vector<double> values(static_cast<std::size_t>(segment_.slots()), 0);
    std::optional<double> common;
    bool uniform = true;
    for (int step = 0; step < segment_.steps; ++step) {
      double spare = 0;
      for (int lane = 0; lane < segment_.width; ++lane) {
        const int b = body(lane, step);
        if (b < 0) continue;
        const NodeId node = of(b);
        if (!state_.constant(node)) return std::nullopt;
        spare = state_.value(node);
      }
      for (int lane = 0; lane < segment_.width; ++lane) {
        const int b = body(lane, step);
        double& x = values[static_cast<std::size_t>(step * segment_.width + lane)];
        x = b >= 0 ? state_.value(of(b)) : elsewhere.value_or(spare);
        if (b < 0 && !elsewhere) continue;
        if (!common) common = x;
        uniform = uniform && x == *common;
      }
    }
    ir::Graph& g = paragraph_->graph;
    if (uniform) return g.constant(common.value_or(0));
    for (std::size_t c = 0; c < code_.columns.size(); ++c)
      if (code_.columns[c].values == values && code_.columns[c].unit == unit) {
        code_.columns[c].add_name(name);
        return g.input({InputKind::table, static_cast<int>(c)});
      }
    code_.columns.push_back({{name}, unit, std::move(values)});
    return g.input({InputKind::table, static_cast<int>(code_.columns.size()) - 1});
  }

  // A parameter, with what payloads add to it.
  NodeId parameter(int p) {
    bool added = false;
    const auto plain = constant(parameter_name(p), parameter_unit(p), value_elsewhere(p), [&](int b) {
      added = added || state_.unroll.added_parameter(p, b) != no_node;
      return state_.unroll.program().graph.is_constant(state_.unroll.parameter(p, b)) ? state_.unroll.parameter(p, b)
                                                                                      : state_.unroll.plain_parameter(p, b);
    });
    if (!added) return *plain;
    return paragraph_->graph.add(*plain, paragraph_->graph.input({InputKind::state, state_.added_parameters.at(p), 0}));
  }

  std::string column_name(int role, int component) const {
    const ir::Role& r = state_.role(role);
    const std::string suffix = ir::component_suffix(r.shape, component);
    return suffix.empty() ? r.name : r.name + "_" + suffix;
  }

  NodeId input(const ir::Sweep& sweep, const ir::Input& in) {
    ir::Graph& g = paragraph_->graph;
    Unroll& u = state_.unroll;
    const RoleComponent value{in.index, in.component};
    switch (in.kind) {
      case InputKind::parameter: return parameter(in.index);
      case InputKind::state: {
        if (const auto made = made_.find(value); made != made_.end()) return made->second;
        const auto fixed = constant(column_name(in.index, in.component), state_.role(in.index).unit,
                                    zero_if(state_.inertial[static_cast<std::size_t>(in.index)]),
                                    [&](int b) { return u.kept(in.index, in.component, b); });
        return fixed ? *fixed : g.input(in);
      }
      case InputKind::carried: {
        if (sweep.direction == Direction::outwards) {
          const auto fixed = constant(
              "parent_" + column_name(in.index, in.component), state_.role(in.index).unit, std::nullopt,
              [&](int b) { return u.kept(in.index, in.component, state_.tree.bodies[static_cast<std::size_t>(b)].parent); });
          return fixed ? *fixed : g.input(in);
        }
        const auto fixed = constant("below_" + column_name(in.index, in.component), state_.role(in.index).unit, 0.0,
                                    [&](int b) { return u.handed(in.index, in.component, b); });
        if (fixed) return *fixed;
        const NodeId along = g.input(in);
        return receives(value) ? g.add(along, g.input({InputKind::received, in.index, in.component})) : along;
      }
      case InputKind::of_body: {
        const NodeId node = u.kept(in.index, in.component, in.body);
        return state_.constant(node) ? g.constant(state_.value(node)) : g.input(in);
      }
      default: return g.input(in);
    }
  }

  ir::SlotLoop loop_of(Direction direction) const {
    using Lanes = ir::SlotLoop::Lanes;
    // Recursions have left a short limb's numbers one by one, or four at a time: what reads more of them waits until all have
    // reached the cache.
    const bool short_limbs = segment_.width <= 4 && segment_.slots() <= (segment_.width == 1 ? 8 : 16);
    const Lanes lanes = direction == Direction::anywhere ? (short_limbs ? Lanes::by_fours : Lanes::along)
                        : segment_.width > 2             ? Lanes::in_parts  // two share any register
                                                         : Lanes::all;
    return {direction, lanes, segment_.first_slot, segment_.steps, segment_.width, segment_.limbs()};
  }

  // Whether limbs hand the value on to bodies of this segment, to a place of its own.
  bool receives(const RoleComponent& value) const {
    if (state_.adds_to_own(static_cast<int>(number_), value)) return false;
    for (int lane = 0; lane < segment_.width; ++lane)
      for (int step = 0; step < segment_.steps; ++step)
        if (body(lane, step) >= 0 && !state_.children[static_cast<std::size_t>(body(lane, step) + 1)].empty()) return true;
    return false;
  }

  void write(const Group& group) {
    if (code_.stages.empty() || code_.stages.back().level != group.level) code_.stages.push_back({group.level, {}});
    auto& paragraphs = code_.stages.back().paragraphs;
    paragraphs.push_back({{}, loop_of(group.direction), ir::Graph(state_.options), {}, {}});
    paragraph_ = &paragraphs.back();
    made_.clear();
    for (const RollStep& step : group.steps) {
      if (step.sweep >= 0) copy(sweep_of(step));
      else copy_base_products(step.pairs);
    }
    if (group.direction == Direction::outwards) carry_outwards();
    for (const ir::Store& s : paragraph_->stores)
      if (varies(s.to.role, s.to.component)) state_.stored[number_].try_emplace({s.to.role, s.to.component}, group.level);
  }

  bool varies(int role, int component) {
    if (static_cast<std::size_t>(role) >= state_.algorithm.roles.size()) return true;
    for (int lane = 0; lane < segment_.width; ++lane)
      for (int step = 0; step < segment_.steps; ++step)
        if (const int b = body(lane, step); b >= 0 && !state_.constant(state_.unroll.kept(role, component, b))) return true;
    return false;
  }

  void copy(const ir::Sweep& sweep) {
    if (!sweep.equation.empty()) paragraph_->equations.push_back(sweep.equation);
    const Live& live = state_.unroll.live();
    ir::Copy copy(sweep.graph, paragraph_->graph);
    const auto of_input = [&](const ir::Input& in) { return input(sweep, in); };
    const auto handed_on = [&](const ir::Value& v) {
      return live.handed[live.at(v.role, v.component)] || live.handed_base[live.at(v.role, v.component)];
    };
    std::vector<NodeId> all;
    for (const ir::Value& v : sweep.stores)
      if (live.body[live.at(v.role, v.component)]) all.push_back(v.node);
    for (const ir::Value& v : sweep.carries)
      if (handed_on(v)) all.push_back(v.node);
    copy.nodes(all, of_input);
    for (const ir::Value& v : sweep.stores)
      if (live.body[live.at(v.role, v.component)])
        paragraph_->stores.push_back({{v.role, v.component}, made_[{v.role, v.component}] = copy.node(v.node, of_input)});
    for (const ir::Value& v : sweep.carries)
      if (handed_on(v)) paragraph_->carried.push_back({v.role, v.component, copy.node(v.node, of_input), {}});
  }

  // Whatever a body of this loop reads of its parent: this body's own is the next one's.
  void carry_outwards() {
    std::set<RoleComponent> read;
    ir::Graph& g = paragraph_->graph;
    for (NodeId id = 0; id < g.size(); ++id)
      if (g[id].op == ir::Op::input && g[id].input.kind == InputKind::carried)
        read.insert({g[id].input.index, g[id].input.component});
    for (const auto& [role, component] : read) {
      const auto made = made_.find({role, component});
      ir::Carried c{role, component, made != made_.end() ? made->second : g.input({InputKind::state, role, component}), {}};
      for (std::size_t lane = 0; lane < segment_.parents.size(); ++lane) {
        const NodeId node = state_.unroll.kept(role, component, segment_.parents[lane]);
        c.initial.push_back(segment_.bodies[lane].front() < 0 || state_.constant(node) ? std::optional(state_.value(node))
                                                                                       : std::nullopt);
      }
      paragraph_->carried.push_back(c);
    }
  }

  // Rows and columns of the base: products with its coordinates, whose roles the unrolled program has.
  void copy_base_products(int pairs) {
    const ir::Pairs& p = state_.algorithm.pairs[static_cast<std::size_t>(pairs)];
    const ir::RolledPairs& to = state_.program.pairs[static_cast<std::size_t>(pairs)];
    const auto add = [&](const std::vector<ir::PairTerm>& terms, int role) {
      ir::Copy copy(state_.unroll.program().graph, paragraph_->graph);
      for (int j = 0; j < state_.tree.base_coordinates(); ++j) {
        NodeId sum = no_node;
        for (const ir::PairTerm& t : terms) {
          NodeId three[3];
          for (int i = 0; i < 3; ++i) {
            const NodeId upper = base_coordinate(copy, t.upper, t.upper_from + i, j);
            const NodeId lower = input({}, {InputKind::state, t.lower, t.lower_from + i});
            three[i] = paragraph_->graph.multiply(lower, upper);
          }
          const NodeId part = paragraph_->graph.add(paragraph_->graph.add(three[0], three[1]), three[2]);
          sum = sum == no_node ? part : paragraph_->graph.add(sum, part);
        }
        paragraph_->stores.push_back({{role, j}, sum});
      }
    };
    add(p.above, to.columns);
    if (!p.below.empty()) add(p.below, to.rows);
  }

  // A role of one of the base's coordinates, in terms of what is kept for the base.
  NodeId base_coordinate(ir::Copy& copy, int role, int component, int coordinate) {
    const NodeId node = state_.unroll.coordinate_role(role, component, coordinate);
    if (node == no_node) return paragraph_->graph.constant(0);
    return copy.node_until(
        node, [&](NodeId id) { return state_.base_values.contains(id) ? of_base(state_.base_values.at(id)) : no_node; },
        [&](const ir::Input& in) { return of_base(input_role(in)); });
  }
  NodeId of_base(const RoleComponent& value) {
    return paragraph_->graph.input({InputKind::of_body, value.first, value.second, -1});
  }
  // An input of the function that is no role of the base: kept for it in a role of its own.
  RoleComponent input_role(const ir::Input& in) {
    const NodeId node = state_.unroll.input_node(in);
    const auto [at, made] = state_.base_values.try_emplace(node, static_cast<int>(state_.program.roles.size()), 0);
    if (made) state_.program.roles.push_back({"input_" + std::to_string(at->second.first), "", "an input of the function", ""});
    return at->second;
  }

  RollState& state_;
  const std::size_t number_;
  const ir::Segment& segment_;
  ir::SegmentCode& code_;
  std::vector<Group> groups_;
  Paragraph* paragraph_ = nullptr;
  std::map<RoleComponent, NodeId> made_;  // by this paragraph
};

}  // namespace

void roll_segments(RollState& state) {
  state.program.segments.resize(state.plan.segments.size());
  state.stored.resize(state.plan.segments.size());
  for (std::size_t s = 0; s < state.plan.segments.size(); ++s) SegmentRoll(state, s).run();
}

}  // namespace dalembert::passes
