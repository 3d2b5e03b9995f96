#include <algorithm>
#include <optional>

#include "passes/joints.hpp"
#include "passes/roll_state.hpp"

namespace dalembert::passes {
namespace {

using ir::Direction;
using ir::InputKind;
using ir::no_node;
using ir::NodeId;

class BaseRoll {
 public:
  explicit BaseRoll(RollState& state) : state_(state) {
    for (const RoleComponent& value : state.base_needs)
      needs_[state.known(value.first) ? state.base_level(value) : 0].insert(value);
    int last = 0;
    for (const int level : state.level) last = std::max(last, (level + 1) / 2 * 2);
    last_ = last;
  }

  // Stages read what earlier ones store: the last first.
  void run() {
    for (int level = last_; level >= 0; level -= 2) {
      stages_.insert(stages_.begin(), {level, {}, ir::Graph(state_.options), {}, {}});
      stage_ = &stages_.front();
      copies_.clear();
      made_.clear();
      const std::vector<ir::Store> to_bodies = level == 0 ? payloads() : std::vector<ir::Store>{};
      if (level == last_) results();
      const auto needed = needs_[level];
      for (const RoleComponent& value : needed) {
        const NodeId node = state_.known(value.first) ? of_base(value.first, value.second, -1) : input_of(value);
        stage_->stores.push_back({{value.first, value.second, -1}, node});
      }
      stage_->stores.insert(stage_->stores.end(), to_bodies.begin(), to_bodies.end());
    }
    std::erase_if(stages_, [](const ir::BaseStage& s) { return s.stores.empty() && s.elements.empty(); });
    state_.program.base = std::move(stages_);
  }

 private:
  ir::Graph& graph() { return stage_->graph; }

  // An input of the function that segments read.
  NodeId input_of(const RoleComponent& value) {
    for (const auto& [node, at] : state_.base_values)
      if (at == value) return graph().input(state_.unroll.program().graph[node].input);
    return no_node;
  }

  // What they add to bodies.
  std::vector<ir::Store> payloads() {
    std::vector<ir::Store> stores;
    ir::Copy copy(state_.unroll.program().graph, graph());
    for (const auto& [parameter, role] : state_.added_parameters)
      for (int body = 0; body < state_.tree.joints(); ++body) {
        const NodeId node = state_.unroll.added_parameter(parameter, body);
        const int segment = state_.plan.segment_of(body);
        if (node == no_node || !state_.read[static_cast<std::size_t>(segment)].contains({role, 0})) continue;
        stores.push_back({{role, 0, body}, copy.node(node, [&](const ir::Input& in) { return graph().input(in); })});
      }
    return stores;
  }

  void results() {
    const ir::Algorithm& a = state_.algorithm;
    const int coordinates = state_.tree.base_coordinates();
    const auto put = [&](int array, int row, int column, NodeId node) {
      row = state_.array(array).row(row), column = state_.array(array).column(column);
      if (row >= 0 && column >= 0 && !graph().is_constant(node, 0)) stage_->elements.push_back({array, row, column, node});
    };
    for (const ir::Pairs& p : a.pairs)
      for (int k = 0; k < coordinates && state_.has_base_rows(p); ++k)
        for (int i = 0; i < coordinates; ++i) {
          NodeId sum = no_node;
          for (const ir::PairTerm& t : p.above)
            for (int c = 0; c < 3; ++c) {
              const NodeId upper = of_base(t.upper, t.upper_from + c, i), lower = of_base(t.lower, t.lower_from + c, k);
              const NodeId product = graph().multiply(lower, upper);
              sum = sum == no_node ? product : graph().add(sum, product);
            }
          put(p.array, i, k, sum);
        }
    for (const ir::Projection& p : a.projections)
      for (int j = 0; j < coordinates; ++j) {
        if (state_.array(p.array).row(j) < 0 || state_.array(p.array).column(0) < 0) continue;
        ir::Copy copy(p.graph, graph());
        for (std::size_t c = 0; c < p.columns.size(); ++c)
          put(p.array, j, static_cast<int>(c), copy.node(p.columns[c], [&](const ir::Input& in) {
            return of_base(in.index, in.component, in.kind == InputKind::carried ? j : -1);
          }));
      }
    for (const ir::Result& r : a.results) {
      const int count = a.roles[static_cast<std::size_t>(r.role)].components();
      for (int i = 0; i < count; ++i) {
        const int rows = a.arrays[static_cast<std::size_t>(r.array)].rows;
        if (r.layout == ir::Layout::base) put(r.array, (r.from + i) % rows, (r.from + i) / rows, of_base(r.role, i, -1));
        for (int j = 0; j < coordinates && r.layout != ir::Layout::base; ++j) {
          const bool columns = r.layout == ir::Layout::columns;
          if ((columns ? state_.array(r.array).column(j) : state_.array(r.array).row(j)) < 0) continue;
          put(r.array, columns ? r.from + i : j, columns ? j : 0, of_base(r.role, i, j));
        }
      }
    }
  }

  // A role of the base, or of one of its coordinates, at this stage.
  NodeId of_base(int role, int component, int coordinate) {
    const NodeId unrolled =
        coordinate < 0 ? state_.unroll.kept(role, component, -1) : state_.unroll.coordinate_role(role, component, coordinate);
    if (state_.constant(unrolled)) return graph().constant(state_.value(unrolled));
    if (coordinate < 0)
      if (const int at = state_.base_level({role, component}); at < stage_->level) {
        needs_[at].insert({role, component});
        return graph().input({InputKind::of_body, role, component, -1});
      }
    const std::tuple key(role, component, coordinate);
    if (const auto made = made_.find(key); made != made_.end()) return made->second;
    const auto [sweep, value] = producer(role, component, coordinate);
    const ir::Sweep& from = state_.algorithm.sweeps[static_cast<std::size_t>(sweep)];
    const auto [copy, fresh] = copies_.try_emplace(sweep, from.graph, graph());
    if (fresh) stage_->equations.push_back(from.equation);
    return made_[key] = copy->second.node(value, [&](const ir::Input& in) { return input(in); });
  }

  // The sweep that stores it at the base, and its node: one of the base's own before one of all bodies.
  std::pair<int, NodeId> producer(int role, int component, int coordinate) const {
    std::pair<int, NodeId> found{-1, no_node};
    for (std::size_t s = 0; s < state_.algorithm.sweeps.size(); ++s) {
      const ir::Sweep& sweep = state_.algorithm.sweeps[s];
      for (const ir::Value& v : sweep.stores) {
        if (v.role != role || v.component != component || v.coordinate != coordinate) continue;
        if (sweep.over.is_base()) return {static_cast<int>(s), v.node};
        found = {static_cast<int>(s), v.node};
      }
    }
    return found;
  }

  NodeId input(const ir::Input& in) {
    ir::Graph& g = graph();
    switch (in.kind) {
      case InputKind::parameter: {
        ir::Copy copy(state_.unroll.program().graph, g);
        return copy.node(state_.unroll.parameter(in.index, -1), [&](const ir::Input& i) { return g.input(i); });
      }
      case InputKind::state: return of_base(in.index, in.component, -1);
      case InputKind::carried: {
        const NodeId sum = state_.unroll.handed(in.index, in.component, -1);
        if (state_.constant(sum)) return g.constant(state_.value(sum));
        // Added already to what the sweep reads beside it.
        if (state_.adds_to_own(-1, {in.index, in.component})) return g.constant(0);
        return g.input({InputKind::received, in.index, in.component});
      }
      case InputKind::of_body: {
        if (in.body < 0) return of_base(in.index, in.component, -1);
        const NodeId node = state_.unroll.kept(in.index, in.component, in.body);
        return state_.constant(node) ? g.constant(state_.value(node)) : g.input(in);
      }
      default: return g.input(in);
    }
  }

  RollState& state_;
  int last_ = 0;
  std::map<int, std::set<RoleComponent>> needs_;  // by stage
  std::vector<ir::BaseStage> stages_;
  ir::BaseStage* stage_ = nullptr;
  std::map<int, ir::Copy> copies_;
  std::map<std::tuple<int, int, int>, NodeId> made_;
};

}  // namespace

void roll_base(RollState& state) { BaseRoll(state).run(); }

}  // namespace dalembert::passes
