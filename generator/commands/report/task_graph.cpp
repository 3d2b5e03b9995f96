#include "commands/report/task_graph.hpp"

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "commands/generated_engine.hpp"
#include "commands/random_states.hpp"
#include "commands/report/rounding.hpp"
#include "lower.hpp"

namespace dalembert::reporting {
namespace {

// In double, whatever the scene's scalar.
Model with_tasks(const Subject& subject) {
  Model model = with_outputs(subject.model, subject.outputs);
  model.scene.scalar = ir::ScalarType::float64;
  model.scene.parallel = ir::Parallel::tasks;
  return model;
}

bool has_several_tasks(const Model& model) {
  const Lowered lowered = lower(model);
  return std::any_of(lowered.functions.begin(), lowered.functions.end(),
                     [](const LoweredFunction& f) { return f.first().plan.tasks && f.first().plan.form == ir::Form::rolled; });
}

// Elements that the task graph computes otherwise than the functions.
double elements_changed(GeneratedEngine& engine, const std::vector<Output>& outputs, const std::vector<State>& states) {
  double count = 0;
  for (const State& state : states) {
    std::vector<Eigen::MatrixXd> by_functions;
    engine.run_task_graphs(false);
    engine.evaluate(state);
    for (const Output& output : outputs) by_functions.push_back(engine.result(output));
    engine.run_task_graphs(true);
    engine.evaluate(state);
    for (size_t o = 0; o < outputs.size(); ++o)
      count += static_cast<double>((engine.result(outputs[o]).array() != by_functions[o].array()).count());
  }
  return count;
}

void add_time(Rows& rows, const char* variant, const CallTime& time) {
  rows.number("rounding", random_case, "all", variant, "time_median", time.median, "ns");
  rows.number("rounding", random_case, "all", variant, "time_lower_quartile", time.lower_quartile, "ns");
  rows.number("rounding", random_case, "all", variant, "time_upper_quartile", time.upper_quartile, "ns");
}

}  // namespace

void TaskGraph::compile() {
  if (subject_.many_outputs()) {
    why_not_ = "it takes a compiler longest of all: a report without --quick has it, and one of four outputs or fewer";
    return;
  }
  const Model model = with_tasks(subject_);
  if (!has_several_tasks(model)) {
    why_not_ = "one straight line of code is one task";
    return;
  }
  try {
    engine_ = std::make_unique<GeneratedEngine>(model, subject_.outputs, subject_.compiler, Besides::task_graphs);
  } catch (const std::runtime_error& e) {
    why_not_ = "it does not compile without oneTBB (" + complaint(e) +
               "): install Debian's libtbb-dev, or name its folders with --flags (-I, -L and -Wl,-rpath)";
  }
}

void TaskGraph::add(Rows& rows) const {
  if (!engine_) {
    rows.text("rounding", random_case, "all", task_graph_variant, "left_out", why_not_);
    return;
  }
  const std::vector<State> states = random_states(subject_.model.tree, 50);
  engine_->run_task_graphs(true);
  rows.number("rounding", random_case, "all", task_graph_variant, "elements_changed",
              elements_changed(*engine_, subject_.outputs, states), "elements");
  add_time(rows, task_graph_variant, engine_->time_per_call(states));
  engine_->run_task_graphs(false);
  add_time(rows, "task graph's functions, one thread", engine_->time_per_call(states));
}

}  // namespace dalembert::reporting
