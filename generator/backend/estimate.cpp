#include "backend/estimate.hpp"

#include <algorithm>
#include <vector>

#include "backend/emit_prepare.hpp"
#include "backend/emit_projections.hpp"
#include "backend/emit_straight.hpp"
#include "backend/executed.hpp"
#include "backend/kept.hpp"
#include "dalembert/chain_shapes.hpp"
#include "ir/coordinate_tree.hpp"
#include "ir/latency.hpp"

namespace dalembert::backend {
namespace {

// Multiply-adds.
constexpr double begun_in_a_cycle = 2;
// Numbers stored one by one must have reached the cache before lanes can read them together.
constexpr double until_lanes_read = 1.1;

double& of(Features& f, Feature feature) { return f[static_cast<size_t>(feature)]; }

// Processors with registers of two are taken to be x86-64's first: without multiply-adds.
bool fused(int lanes) { return lanes > 2; }

int registers(int count, int lanes) { return (count + lanes - 1) / lanes; }

// Of `all` divisions those that something waits for: `in_a_row` wait for each other, and others begin meanwhile.
double waited_divisions(double all, double in_a_row) {
  constexpr double begun_meanwhile = 0.3;
  return std::min(all, in_a_row) + begun_meanwhile * std::max(0.0, all - in_a_row);
}

// Multiply-adds, and what stands alone, of a graph; and cycles from one of its inputs to one of its outputs.
class Work {
 public:
  // `fused`: whether a product and a sum are one instruction.
  Work(const ir::Graph& graph, const std::vector<ir::NodeId>& roots, bool fused)
      : graph_(graph), uses_(ir::uses(graph, roots)), fused_(fused), divisions_behind_(static_cast<size_t>(graph.size())) {
    for (ir::NodeId id = 0; id < graph.size(); ++id) {
      const ir::Node& n = graph[id];
      if (used(id) == 0) continue;
      if (n.op == ir::Op::divide) ++divisions_;
      for (const ir::NodeId from : {n.a, n.b})
        if (from != ir::no_node) behind(id) = std::max(behind(id), behind(from));
      if (n.op == ir::Op::divide) most_divisions_ = std::max(most_divisions_, ++behind(id));
      if (n.op == ir::Op::multiply) ++operations_;
      if ((n.op == ir::Op::add || n.op == ir::Op::subtract) && !absorbs(n)) ++operations_;
    }
  }

  double operations() const { return operations_; }
  double divisions() const { return divisions_; }
  double divisions_waited_for() const { return waited_divisions(divisions_, most_divisions_); }

  // Cycles from what `starts` says to each of `ends`; the longest way.
  template <class Starts>
  double longest(const Starts& starts, const std::vector<ir::NodeId>& ends) const {
    std::vector<double> ready(static_cast<size_t>(graph_.size()), -1);  // −1: does not wait
    for (ir::NodeId id = 0; id < graph_.size(); ++id) {
      const ir::Node& n = graph_[id];
      double& r = ready[static_cast<size_t>(id)];
      if (n.op == ir::Op::input) {
        if (starts(n.input)) r = 0;
        continue;
      }
      double before = -1;
      for (const ir::NodeId from : {n.a, n.b})
        if (from != ir::no_node) before = std::max(before, ready[static_cast<size_t>(from)]);
      if (before >= 0) r = before + cycles(n, id);
    }
    double most = 0;
    for (const ir::NodeId end : ends) most = std::max(most, ready[static_cast<size_t>(end)]);
    return most;
  }

 private:
  int& behind(ir::NodeId id) { return divisions_behind_[static_cast<size_t>(id)]; }
  std::int32_t used(ir::NodeId id) const { return uses_[static_cast<size_t>(id)]; }
  bool is_product(ir::NodeId id) const { return graph_[id].op == ir::Op::multiply && used(id) == 1; }
  // A sum with a product that nobody else reads is one instruction with it.
  bool absorbs(const ir::Node& n) const { return fused_ && (is_product(n.a) || is_product(n.b)); }
  double cycles(const ir::Node& n, ir::NodeId id) const {
    switch (n.op) {
      case ir::Op::multiply: return fused_ && used(id) == 1 ? 0 : ir::latency;
      case ir::Op::divide: return ir::divide_latency;
      case ir::Op::negate: return 0;
      default: return ir::latency;
    }
  }

  const ir::Graph& graph_;
  const std::vector<std::int32_t> uses_;
  const bool fused_;
  double operations_ = 0, divisions_ = 0;
  std::vector<int> divisions_behind_;  // of each node, one behind the other
  int most_divisions_ = 0;
};

bool any_input(const ir::Input&) { return true; }

void add_kernels(const CodeInput& code, Features& f) {
  const ir::CoordinateTree tree = ir::coordinate_tree(code.tree);
  const double in_a_row = ir::most_above(tree) + 1;
  for (const ir::Kernel& kernel : code.algorithm.kernels) {
    const ir::Operations o = ir::operations_of(kernel, code.tree, true, code.is_rolled());
    of(f, Feature::step_operations) += static_cast<double>(o.multiply);
    const bool by_known_pivots = kernel.kind == ir::Kernel::Kind::solve;
    of(f, Feature::divide) += waited_divisions(static_cast<double>(o.divide), by_known_pivots ? 1 : in_a_row);
    if (kernel.of_constraints()) continue;
    const bool solves = kernel.kind == ir::Kernel::Kind::factor || kernel.kind == ir::Kernel::Kind::solve;
    if (!solves || tree.size() > most_written_out)
      of(f, Feature::step_chains) += static_cast<double>(ir::chains(tree, kernel.first).size());
  }
}

Work add_straight(const ir::Graph& graph, const std::vector<ir::NodeId>& roots, int lanes, Features& f) {
  Work work(graph, roots, fused(lanes));
  of(f, Feature::scalar) += work.operations();
  of(f, Feature::divide) += work.divisions_waited_for();
  of(f, Feature::stores) += static_cast<double>(roots.size());
  return work;
}

// Of one register.
double operations_in_lanes(const ir::Graph& graph, const std::vector<ir::NodeId>& roots, const std::vector<ir::Store>& stores,
                           int lanes) {
  const Work work(graph, roots, fused(lanes));
  return work.operations() + 4 * work.divisions() + static_cast<double>(stores.size()) / 2;
}

void add_written(const std::vector<ir::LimbStep>& steps, const ir::SlotLoop& loop, int lanes, Features& f) {
  const bool alone = loop.width == 1;
  const Feature feature = alone ? Feature::scalar : Feature::lanes;
  const double before = of(f, feature);
  double recurrence = 0;
  for (const ir::LimbStep& step : steps) {
    if (alone) {
      add_straight(step.graph, step.roots(), lanes, f);
      of(f, Feature::waits) += until_lanes_read * static_cast<double>(step.stores.size());
    } else {
      of(f, Feature::lanes) += loop.side_by_side(lanes) * operations_in_lanes(step.graph, step.roots(), step.stores, lanes);
    }
    if (&step == &steps.front() || &step == &steps.back()) continue;
    std::vector<ir::NodeId> handed;
    for (const ir::Carried& c : step.carried) handed.push_back(c.node);
    const auto carried = [](const ir::Input& in) { return in.kind == ir::InputKind::carried; };
    recurrence += Work(step.graph, step.roots(), fused(lanes)).longest(carried, handed);
  }
  of(f, Feature::waits) += std::max(0.0, recurrence - (of(f, feature) - before) / begun_in_a_cycle);
}

void add_paragraph(const ir::Paragraph& p, int lanes, Features& f) {
  const std::vector<ir::NodeId> roots = p.roots();
  std::vector<ir::NodeId> handed;
  for (const ir::Carried& c : p.carried) handed.push_back(c.node);
  const Work work(p.graph, roots, fused(lanes));
  const auto carried = [](const ir::Input& in) { return in.kind == ir::InputKind::carried; };
  // The first step's inputs, the last step's outputs: nothing else is there to be done.
  const double ends = p.loop.by_steps() ? work.longest(any_input, roots) : 0;
  of(f, Feature::waits) += ends;
  if (!p.written.empty()) return add_written(p.written, p.loop, lanes, f);
  const double trips = p.loop.trips(lanes);
  const double operations = p.loop.side_by_side(lanes) * operations_in_lanes(p.graph, roots, p.stores, lanes);
  of(f, Feature::lanes) += trips * operations;
  of(f, Feature::loops) += 1;
  if (p.loop.by_steps())
    of(f, Feature::waits) += std::max(0.0, (trips - 1) * (work.longest(carried, handed) - operations / begun_in_a_cycle));
}

void add_elements(const CodeInput& code, size_t segment, int lanes, Features& f) {
  const ir::Segment& s = code.plan.segments[segment];
  const Feature feature = s.limb_after_limb ? Feature::along : Feature::tiles;
  for (const ir::PairBlocks& matrices : code.rolled.blocks)
    for (const ir::ElementSums& sums : matrices.sums) {
      const ir::ElementCounts computed =
          ir::element_counts(code.tree, s, matrices, matrices.segments[segment], sums.symmetric, lanes);
      const auto add = [&](const std::vector<ir::FactorTerm>& terms, long elements) {
        of(f, feature) += 3.0 * static_cast<double>(terms.size()) * static_cast<double>(elements) / lanes;
      };
      add(sums.above, computed.above);
      add(sums.symmetric ? sums.above : sums.below, computed.below);
      of(f, Feature::stores) += static_cast<double>(computed.above + computed.below) / lanes;
      of(f, Feature::loops) += 1;
    }
}

void add_projections(const CodeInput& code, int lanes, Features& f) {
  for (size_t number = 0; number < code.algorithm.projections.size(); ++number) {
    const ir::Projection& p = code.algorithm.projections[number];
    const std::vector<ir::ProjectedBody>& bodies = projected_bodies(code, number);
    if (bodies.empty()) continue;
    const double columns = static_cast<double>(p.columns.size()),
                 registers = static_cast<double>(ir::row_counts(bodies, lanes).registers);
    constexpr double waited = 25;  // for sums that few joints have: each is a chain, and the next body's begin behind them
    of(f, Feature::lanes) += registers * (Work(p.graph, p.columns, fused(lanes)).operations() + columns / 2 + waited);
    of(f, Feature::loops) += 1;
    if (!code.is_rolled()) continue;
    // Copies of the joints' numbers, and of bodies' that are the base's rows, of which every second sum takes a product with
    // it.
    const ir::RolledProjection& rolled = code.rolled.projections[number];
    const ir::Operations of_base = ir::count(rolled.graph, ir::uses(rolled.graph, rolled.roots()));
    const double each = static_cast<double>(of_base.multiply) + static_cast<double>(of_base.add) / (fused(lanes) ? 2 : 1);
    of(f, Feature::scalar) += each * static_cast<double>(bodies.size());
    constexpr double read_apart = 3;  // each number from a line of its own
    of(f, Feature::stores) += read_apart * static_cast<double>(rolled.base.size() * bodies.size());
    of(f, Feature::stores) += 6.0 * code.tree.joints() * (1 + columns * base_rows(code) / 60);
  }
}

// Of a straight line of more instructions the caches of decoded or of fetched ones hold nothing when it begins anew: all of it
// is fetched again, in every call. Processors with registers of four decode less ahead: the cache of decoded instructions of
// Zen 3 and its like holds 4096, among them loads and stores, of newer ones half as many again.
struct Fetching {
  double cached, uncached;
};
constexpr Fetching fetching[3] = {{2300, 2700}, {1750, 2000}, {2300, 2700}};

int width_index(int lanes) { return lanes <= 2 ? 0 : lanes <= 4 ? 1 : 2; }

double fetched(double instructions, int lanes) {
  const Fetching& f = fetching[width_index(lanes)];
  return instructions * std::clamp((instructions - f.cached) / (f.uncached - f.cached), 0.0, 1.0);
}

// ns per unit of each feature; by registers of two, four and eight. Those of `along` are read off the elements' times of chains
// of 50 to 500 joints (AMD EPYC, Zen 4).
constexpr Features constants[3] = {
    {4.02, 0.121, 0.098, 7.28, 5.59, 0.146, 0.0371, 0, 0.292, 0.25, 0.0593, 0.0787, 22.2},
    {4.18, 0.163, 0.12, 5.39, 4.64, 0.152, 0.101, 0, 0.345, 0.15, 0.019, 0.0633, 13.3},
    {3.28, 0.131, 0.0948, 11.3, 3.2, 0.162, 0.0844, 0, 0.531, 0.31, 0.061, 0.0546, 7.4},
};

}  // namespace

const Features& committed_constants(int lanes) { return constants[width_index(lanes)]; }

int usual_lanes(const CodeInput& code) { return code.plan.costs ? code.plan.costs->lanes : register_widths[usual_width]; }

const char* const feature_names[feature_count] = {"call",   "scalar",          "fetched",    "sines", "divisions",
                                                  "lanes",  "waits",           "loops",      "tiles", "along",
                                                  "stores", "step_operations", "step_chains"};

namespace {

void add_base(const CodeInput& code, int level, int lanes, Features& f) {
  for (const ir::BaseStage& stage : code.rolled.base) {
    if (stage.level != level) continue;
    add_straight(stage.graph, stage.roots(), lanes, f);
  }
  if (level == 0) of(f, Feature::sines) = registers(static_cast<int>(prepare_operations(code).sincos), lanes);
}

void add_segment(const CodeInput& code, size_t segment, int level, int lanes, Features& f) {
  for (const ir::SegmentStage& stage : code.rolled.segments[segment].stages)
    for (const ir::Paragraph& p : stage.paragraphs)
      if (stage.level == level) add_paragraph(p, lanes, f);
}

// What stands behind the sweeps, in either form.
void add_steps_behind(const CodeInput& code, int lanes, Features& f) {
  add_kernels(code, f);
  add_projections(code, lanes, f);
}

void add_results(const CodeInput& code, int lanes, Features& f) {
  add_steps_behind(code, lanes, f);
  const std::optional<ir::Guard>& guard = code.algorithm.guard;
  const auto copied = std::count_if(code.algorithm.results.begin(), code.algorithm.results.end(), [&](const ir::Result& r) {
    return !guard || !guard->tells_by(r.array);  // those stay where limbs leave them
  });
  of(f, Feature::stores) += static_cast<double>(code.tree.joints() * copied);
}

double nanoseconds(const CodeInput& code, const Features& f, int lanes) {
  const ir::MachineCosts* const measured = code.plan.costs.get();
  const double* const constant =
      measured && measured->lanes == lanes ? measured->per_feature.data() : committed_constants(lanes).data();
  double sum = 0;
  for (size_t i = 0; i < feature_count; ++i) sum += constant[i] * f[i];
  return sum;
}

}  // namespace

Features features(const CodeInput& code, int lanes) {
  Features f{};
  of(f, Feature::call) = 1;
  if (!code.is_rolled()) {
    add_steps_behind(code, lanes, f);
    const std::vector<ir::NodeId> roots = code.program.roots();
    const Work work = add_straight(code.program.graph, roots, lanes, f);
    of(f, Feature::waits) = std::max(0.0, work.longest(any_input, roots) - work.operations() / begun_in_a_cycle);
    of(f, Feature::fetched) = fetched(of(f, Feature::scalar), lanes);
    of(f, Feature::sines) = registers(static_cast<int>(straight_operations(code).sincos), lanes);
    return f;
  }
  for (int level = 0; level < code.rolled.levels(); ++level) {
    add_base(code, level, lanes, f);
    for (size_t s = 0; s < code.plan.segments.size(); ++s) add_segment(code, s, level, lanes, f);
  }
  for (size_t s = 0; s < code.plan.segments.size(); ++s) add_elements(code, s, lanes, f);
  add_results(code, lanes, f);
  return f;
}

double estimate(const CodeInput& code, int lanes) { return nanoseconds(code, features(code, lanes), lanes); }

double estimate(const CodeInput& code, const Stage& stage, int lanes) {
  Features f{};
  const size_t segment = static_cast<size_t>(std::max(stage.segment, 0));
  switch (stage.kind) {
    case Stage::Kind::base: add_base(code, stage.level, lanes, f); break;
    case Stage::Kind::segment: add_segment(code, segment, stage.level, lanes, f); break;
    case Stage::Kind::elements: add_elements(code, segment, lanes, f); break;
    case Stage::Kind::results: add_results(code, lanes, f); break;
  }
  return nanoseconds(code, f, lanes);
}

}  // namespace dalembert::backend
