#include "lower.hpp"

#include "passes/normalise.hpp"
#include "passes/plan.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/roll.hpp"
#include "passes/unroll.hpp"

namespace dalembert {
namespace {

enum class Depth { program, form };

// The function, or its two halves, which have one plan, by what they cost together.
std::vector<LoweredFunction> lower(const Model& model, const ir::NormalTree& normal, const ir::EmittedFunction& function,
                                   Depth depth) {
  const ir::Graph::Options options{model.options.fold, model.options.share};
  // Nobody reads a straight line of a million statements.
  const bool names = depth == Depth::form && model.tree.joints() < 200;
  const std::vector<ir::EmittedFunction> halves = passes::halves(function, model.tree);
  std::vector<LoweredFunction> lowered(halves.size());
  std::vector<passes::Unroll> unrolled;
  unrolled.reserve(halves.size());
  ir::Operations operations;
  for (size_t half = 0; half < halves.size(); ++half) {
    lowered[half].algorithm = passes::describe(halves[half], model.tree, normal, model.scene, options);
    unrolled.emplace_back(lowered[half].algorithm, model.tree, normal, model.scene, passes::UnrollOptions{options, names});
    if (depth == Depth::program) continue;
    const ir::Program& program = unrolled[half].program();
    operations += ir::count(program.graph, ir::uses(program.graph, program.roots()));
  }
  for (size_t half = 0; half < halves.size(); ++half) {
    LoweredFunction& f = lowered[half];
    if (depth == Depth::form) {
      f.plan = passes::plan(model.tree, model.scene, operations, model.options);
      if (f.plan.form == ir::Form::rolled)
        f.rolled = passes::roll(f.algorithm, unrolled[half], model.tree, model.scene, f.plan, options);
    }
    f.program = unrolled[half].take_program();
  }
  return lowered;
}

Lowered lower(const Model& model, Depth depth) {
  Lowered lowered;
  lowered.normal = passes::normalise(model.tree, passes::normalise_options(model.scene, model.options.move_parameters));
  for (const ir::EmittedFunction& function : ir::functions_of(model.scene))
    for (LoweredFunction& half : lower(model, lowered.normal, function, depth)) lowered.functions.push_back(std::move(half));
  return lowered;
}

}  // namespace

Lowered lower(const Model& model) { return lower(model, Depth::form); }
Lowered lower_to_programs(const Model& model) { return lower(model, Depth::program); }

}  // namespace dalembert
