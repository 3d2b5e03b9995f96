#include "passes/roll.hpp"

#include <algorithm>
#include <functional>

#include "passes/joints.hpp"
#include "passes/joints/quaternion.hpp"
#include "passes/levels.hpp"
#include "passes/live_lanes.hpp"
#include "passes/parameters.hpp"
#include "passes/roll_state.hpp"
#include "passes/write_limbs.hpp"

namespace dalembert::passes {
namespace {

using ir::Direction;
using ir::InputKind;

std::vector<int> handed_levels(const ir::Algorithm& algorithm, const std::vector<int>& level) {
  std::vector<int> handed(algorithm.roles.size(), -1);
  for (std::size_t s = 0; s < algorithm.sweeps.size(); ++s)
    for (const ir::Value& v : algorithm.sweeps[s].carries) handed[static_cast<std::size_t>(v.role)] = level[s];
  return handed;
}

// Limbs hand on to what is kept of a role, where nobody reads the role itself once they have begun to.
std::vector<bool> added_in_place(const ir::Algorithm& algorithm, const std::vector<int>& level) {
  std::vector<bool> in_place(algorithm.roles.size(), true);
  const std::vector<int> handed = handed_levels(algorithm, level);
  const auto refuse = [&](int role) { in_place[static_cast<std::size_t>(role)] = false; };
  for (std::size_t s = 0; s < algorithm.sweeps.size(); ++s) {
    std::vector<bool> sums(algorithm.roles.size(), false);
    const ir::Sweep& sweep = algorithm.sweeps[s];
    std::vector<ir::NodeId> all;
    for (const auto* values : {&sweep.stores, &sweep.carries})
      for (const ir::Value& v : *values) all.push_back(v.node);
    each_input(sweep.graph, all, [&](const ir::Input& in) {
      if (in.kind == InputKind::carried && sweep.direction == Direction::inwards)
        sums[static_cast<std::size_t>(in.index)] = true;
    });
    each_input(sweep.graph, all, [&](const ir::Input& in) {
      const bool reads = in.kind == InputKind::state || in.kind == InputKind::of_body;
      if (!reads || in.index >= static_cast<int>(handed.size())) return;
      const int from = handed[static_cast<std::size_t>(in.index)];
      if (from >= 0 && level[s] >= from && !sums[static_cast<std::size_t>(in.index)]) refuse(in.index);
    });
  }
  for (const ir::Pairs& p : algorithm.pairs) {
    for (const auto* terms : {&p.above, &p.below})
      for (const ir::PairTerm& t : *terms) refuse(t.lower), refuse(t.upper);
    if (p.between >= 0) refuse(p.between);
  }
  for (const ir::Result& r : algorithm.results) refuse(r.role);
  return in_place;
}

std::vector<bool> inertial_roles(const ir::Algorithm& algorithm) {
  std::vector<bool> inertial(algorithm.roles.size(), false);
  for (const ir::Sweep& sweep : algorithm.sweeps) {  // every sweep stands behind those it reads from
    bool any = false;
    for (ir::NodeId id = 0; id < sweep.graph.size(); ++id) {
      const ir::Node& n = sweep.graph[id];
      if (n.op != ir::Op::input) continue;
      const auto at = static_cast<std::size_t>(n.input.index);
      any = any || (n.input.kind == InputKind::parameter && is_inertial(n.input.index)) ||
            (n.input.kind == InputKind::state && inertial[at]);
    }
    for (const ir::Value& v : sweep.stores)
      if (any) inertial[static_cast<std::size_t>(v.role)] = true;
  }
  return inertial;
}

// Roles the base has from the start: what else depends on them reads them there.
void collect_base_values(RollState& state) {
  const Live& live = state.unroll.live();
  for (std::size_t s = 0; s < state.algorithm.sweeps.size(); ++s) {
    const ir::Sweep& sweep = state.algorithm.sweeps[s];
    if (!sweep.over.is_base() || state.level[s] > 0) continue;
    for (const ir::Value& v : sweep.stores) {
      if (v.coordinate >= 0 || !live.base[live.at(v.role, v.component)]) continue;
      const ir::NodeId node = state.unroll.role(v.role, v.component, -1);
      if (!state.constant(node)) state.base_values.try_emplace(node, v.role, v.component);
    }
  }
}

void collect_steps(RollState& state) {
  const auto producer = [&](int role) {
    for (std::size_t s = 0; s < state.algorithm.sweeps.size(); ++s)
      if (!state.algorithm.sweeps[s].over.is_base())
        for (const ir::Value& v : state.algorithm.sweeps[s].stores)
          if (v.role == role) return static_cast<int>(s);
    return -1;
  };
  std::vector<int> after(state.algorithm.pairs.size(), -1);  // per pairs: the last sweep that makes a factor
  for (std::size_t p = 0; p < after.size(); ++p)
    for (const auto* terms : {&state.algorithm.pairs[p].above, &state.algorithm.pairs[p].below})
      for (const ir::PairTerm& t : *terms) after[p] = std::max(after[p], producer(t.lower));
  for (std::size_t s = 0; s < state.algorithm.sweeps.size(); ++s) {
    if (state.algorithm.sweeps[s].over.is_base()) continue;
    state.steps.push_back({static_cast<int>(s), -1, state.level[s]});
    for (std::size_t p = 0; p < after.size(); ++p)
      if (after[p] == static_cast<int>(s) && state.has_base_rows(state.algorithm.pairs[p]))
        state.steps.push_back({-1, static_cast<int>(p), state.level[s]});
  }
}

int add_role(RollState& state, const ir::Role& role) {
  state.program.roles.push_back(role);
  return static_cast<int>(state.program.roles.size()) - 1;
}

void add_roles(RollState& state) {
  for (const ir::Pairs& p : state.algorithm.pairs) {
    ir::RolledPairs rolled;
    const std::string& name = state.algorithm.arrays[static_cast<std::size_t>(p.array)].name;
    if (state.has_base_rows(p)) {
      rolled.columns =
          add_role(state, {name + "_columns", "", "the base's rows of the joint's column of " + name, "", ir::Shape::wrench});
      if (!p.below.empty())
        rolled.rows =
            add_role(state, {name + "_rows", "", "the base's columns of the joint's row of " + name, "", ir::Shape::wrench});
      else if (p.symmetric) rolled.rows = rolled.columns;
    }
    state.program.pairs.push_back(rolled);
  }
  for (int parameter = rotation_p; parameter < bears_p; ++parameter)
    for (int body = 0; body < state.tree.joints(); ++body)
      if (state.unroll.added_parameter(parameter, body) != ir::no_node && !state.added_parameters.contains(parameter)) {
        const std::string name = parameter_name(parameter);
        const bool payload = is_inertial(parameter);
        state.added_parameters[parameter] = add_role(
            state, {(payload ? "payload_" : "quaternion_") + name, "",
                    (payload ? "what payloads add to " : "of joints with a quaternion: ") + name, parameter_unit(parameter)});
      }
}

}  // namespace

int RollState::base_level(const RoleComponent& value) const {
  int found = 0;
  for (std::size_t s = 0; s < algorithm.sweeps.size(); ++s)
    for (const ir::Value& v : algorithm.sweeps[s].stores) {
      if (RoleComponent(v.role, v.component) != value || v.coordinate >= 0) continue;
      if (algorithm.sweeps[s].over.is_base()) return level[s];
      found = (level[s] + 1) / 2 * 2;
    }
  return found;
}

bool RollState::adds_to_own(int segment, const RoleComponent& value) const {
  const auto role = static_cast<std::size_t>(value.first);
  if (!in_place[role]) return false;
  if (segment < 0) return base_level(value) < handed_level[role] && !constant(unroll.kept(value.first, value.second, -1));
  const auto& own = stored[static_cast<std::size_t>(segment)];
  const auto at = own.find(value);
  return at != own.end() && at->second < handed_level[role];
}

ir::RolledProgram roll(const ir::Algorithm& algorithm, Unroll& unroll, const ir::KinematicTree& tree, const ir::Scene& scene,
                       const ir::Plan& plan, const ir::Graph::Options& options) {
  RollState state{algorithm, unroll, tree, scene, plan, options, levels(algorithm)};
  state.inertial = inertial_roles(algorithm);
  state.handed_level = handed_levels(algorithm, state.level);
  state.in_place = added_in_place(algorithm, state.level);
  state.program.roles = algorithm.roles;
  collect_base_values(state);
  collect_steps(state);
  add_roles(state);
  state.children.resize(tree.bodies.size() + 1);
  for (const ir::Segment& s : plan.segments)
    for (std::size_t lane = 0; lane < s.parents.size(); ++lane)
      if (s.bodies[lane].front() >= 0)
        state.children[static_cast<std::size_t>(s.parents[lane] + 1)].push_back(s.bodies[lane].front());
  const std::vector<int> coordinates = tree.coordinates();
  for (const ir::Pairs& p : algorithm.pairs)
    for (int k = 0; k < tree.joints() && p.diagonal >= 0; ++k) {
      const int row = tree.base_coordinates() + coordinates[static_cast<std::size_t>(k)];
      const double value = unroll.program().graph[unroll.plain_parameter(p.diagonal, k)].value;
      const int at = state.array(p.array).row(row);
      if (value != 0 && at >= 0) state.program.added.push_back({p.array, at, at, value});
    }
  for (const ir::Pairs& p : algorithm.pairs)
    for (int k = 0; k < tree.joints() && p.between >= 0; ++k) {
      if (!tree.bodies[static_cast<std::size_t>(k)].has_quaternion()) continue;
      each_bracket(tree, k, [&](int lower, int upper, int body, int sign) {
        const auto row = [&](int of) {
          return state.array(p.array).row(tree.base_coordinates() + coordinates[static_cast<std::size_t>(of)]);
        };
        if (row(upper) >= 0 && row(lower) >= 0 && !state.constant(unroll.role(p.between, 0, body)))
          state.program.added.push_back({p.array, row(upper), row(lower), static_cast<double>(sign), p.between, body});
      });
    }
  roll_segments(state);
  prune(state);
  roll_base(state);
  roll_pairs(state);
  roll_projections(state);
  roll_results(state);
  place(state);
  leave_in_slots(state);
  find_live_lanes(algorithm, plan, state.program);
  write_limbs(plan, state.program);
  return std::move(state.program);
}

}  // namespace dalembert::passes
