#include "lower.hpp"

#include "passes/normalise.hpp"
#include "passes/plan.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/roll.hpp"
#include "passes/unroll.hpp"

namespace dalembert {
namespace {

enum class Depth { program, form };

LoweredFunction lower(const Model& model, const ir::NormalTree& normal, const ir::EmittedFunction& function, Depth depth) {
  const ir::Graph::Options options{model.options.fold, model.options.share};
  LoweredFunction lowered;
  lowered.algorithm = passes::describe(function, model.tree, normal, model.scene, options);
  // Nobody reads a straight line of a million statements.
  const bool names = depth == Depth::form && model.tree.joints() < 200;
  passes::Unroll unroll(lowered.algorithm, model.tree, normal, model.scene, {options, names});
  if (depth == Depth::form) {
    const ir::Program& program = unroll.program();
    const ir::Operations operations = ir::count(program.graph, ir::uses(program.graph, program.roots()));
    lowered.plan = passes::plan(model.tree, model.scene, operations, model.options);
    if (lowered.plan.form == ir::Form::rolled)
      lowered.rolled = passes::roll(lowered.algorithm, unroll, model.tree, model.scene, lowered.plan, options);
  }
  lowered.program = unroll.take_program();
  return lowered;
}

Lowered lower(const Model& model, Depth depth) {
  Lowered lowered;
  lowered.normal = passes::normalise(model.tree, passes::normalise_options(model.scene, model.options.move_parameters));
  for (const ir::EmittedFunction& f : ir::functions_of(model.scene))
    for (const ir::EmittedFunction& half : passes::halves(f, model.tree)) {
      lowered.functions.push_back(lower(model, lowered.normal, half, depth));
      if (half.first_half.empty()) continue;
      ir::Plan &first = (lowered.functions.end() - 2)->plan, &second = lowered.functions.back().plan;
      first.tasks = second.tasks = first.tasks || second.tasks;  // one graph
    }
  return lowered;
}

}  // namespace

Lowered lower(const Model& model) { return lower(model, Depth::form); }
Lowered lower_to_programs(const Model& model) { return lower(model, Depth::program); }

}  // namespace dalembert
