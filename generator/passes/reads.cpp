#include "passes/reads.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "ir/algorithm.hpp"
#include "passes/embedding.hpp"
#include "passes/normalise.hpp"
#include "passes/quantities/quantities.hpp"

namespace dalembert::passes {
namespace {

using Component = std::pair<int, int>;  // of a role

// A sweep's graph where rates may be known to be zero, and what each value of it reads.
class ReadSweep {
 public:
  ReadSweep(const ir::Algorithm& algorithm, const ir::Sweep& sweep, bool rates_zero) {
    ir::Copy copy(sweep.graph, graph_);
    const auto input = [&](const ir::Input& i) {
      const bool of_role =
          i.kind == ir::InputKind::state || i.kind == ir::InputKind::carried || i.kind == ir::InputKind::of_body;
      const bool still = rates_zero && of_role && algorithm.roles[static_cast<std::size_t>(i.index)].source == ir::Source::rate;
      return still ? graph_.constant(0) : graph_.input(i);
    };
    for (const std::vector<ir::Value>* values : {&sweep.stores, &sweep.carries})
      for (const ir::Value& value : *values) values_.push_back({{value.role, value.component}, copy.node(value.node, input)});
  }

  // Of the values that are wanted. `read`: ir::Input → void.
  template <class Read>
  void each_input(const std::set<Component>& wanted, const Read& read) const {
    std::vector<ir::NodeId> roots;
    for (const auto& [component, node] : values_)
      if (wanted.contains(component)) roots.push_back(node);
    ir::each_input(graph_, roots, read);
  }

 private:
  ir::Graph graph_;
  std::vector<std::pair<Component, ir::NodeId>> values_;
};

// Components of roles that arrays are made of.
std::set<Component> results_of(const ir::Algorithm& section) {
  std::set<Component> wanted;
  const auto whole = [&](int role) {
    for (int i = 0; role >= 0 && i < section.roles[static_cast<std::size_t>(role)].components(); ++i) wanted.insert({role, i});
  };
  for (const ir::Result& result : section.results) whole(result.role);
  for (const ir::Pairs& pairs : section.pairs) {
    for (const std::vector<ir::PairTerm>* terms : {&pairs.above, &pairs.below})
      for (const ir::PairTerm& term : *terms) whole(term.lower), whole(term.upper);
    whole(pairs.between);
  }
  for (const ir::Projection& projection : section.projections)
    for (const ir::InputKind kind : {ir::InputKind::state, ir::InputKind::carried})
      for (const ir::Input& input : projection.inputs(kind)) wanted.insert({input.index, input.component});
  return wanted;
}

}  // namespace

Reads::Reads(const ir::KinematicTree& tree, const ir::Scene& scene) {
  const bool embedded = !tree.linkages.empty();
  const ir::KinematicTree own_tree = embedded ? tree.opened() : tree;
  const ir::Scene own_scene = embedded ? opened(scene) : scene;
  const ir::NormalTree normal = normalise(own_tree, normalise_options(own_scene, true));
  for (const ir::EmittedFunction& function : ir::functions_of(scene)) {
    const ir::EmittedFunction own = embedded ? embed(function, tree, scene).of_opened : function;
    for (const ir::Algorithm& section : describe(own, own_tree, normal, own_scene, {})) {
      for (const ir::Pairs& pairs : section.pairs)
        if (pairs.diagonal >= 0) parameters_.insert(pairs.diagonal);
      std::vector<ReadSweep> sweeps;
      for (const ir::Sweep& sweep : section.sweeps) sweeps.emplace_back(section, sweep, own_scene.rates_zero);
      std::set<Component> wanted = results_of(section);
      for (std::size_t before = 0; before != wanted.size();) {
        before = wanted.size();
        for (const ReadSweep& sweep : sweeps)
          sweep.each_input(wanted, [&](const ir::Input& input) {
            inputs_.insert(input.kind);
            if (input.kind == ir::InputKind::parameter) parameters_.insert(input.index);
            if (input.kind == ir::InputKind::state || input.kind == ir::InputKind::carried ||
                input.kind == ir::InputKind::of_body)
              wanted.insert({input.index, input.component});
          });
      }
    }
  }
}

bool Reads::mass() const {
  return std::any_of(parameters_.begin(), parameters_.end(), [](int p) { return p >= mass_p && p <= half_trace_p; });
}

}  // namespace dalembert::passes
