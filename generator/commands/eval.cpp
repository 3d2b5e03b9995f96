#include "commands/eval.hpp"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <memory>

#include "commands/batch_engine.hpp"
#include "commands/finite_inputs.hpp"
#include "commands/generated_engine.hpp"
#include "commands/generic_engine.hpp"
#include "passes/joints_without_mass.hpp"
#include "reference/solvable.hpp"

namespace dalembert {

namespace {

void append_rows(std::string& text, const Eigen::MatrixXd& matrix) {
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    for (Eigen::Index k = 0; k < matrix.cols(); ++k) {
      const double x = matrix(i, k);
      text += std::isnan(x) ? "nan" : fmt::format("{:.17g}", x);
      text += k + 1 < matrix.cols() ? ' ' : '\n';
    }
}

}  // namespace

std::string evaluate(const Model& model, const std::string& state_file, const std::string& output, Engine engine,
                     const CompilerOptions& options, Diagnostics& warnings) {
  const Output wanted = output_named(model, output);
  const ir::Scene scene = with_outputs(model, {wanted}).scene;
  passes::check_mass(model.description, model.tree, scene);
  reference::check_solvable(model.description, model.tree, scene);
  const std::vector<State> states = read_states(state_file, model.tree, wanted.function.inputs, warnings);
  std::unique_ptr<GeneratedEngine> generated;
  if (engine == Engine::generated) generated = std::make_unique<GeneratedEngine>(model, std::vector{wanted}, options);

  std::unique_ptr<BatchEngine> batch;
  if (engine == Engine::batch) {
    batch = std::make_unique<BatchEngine>(model, std::vector{wanted}, options);
    batch->evaluate(states);
  }

  std::string text;
  const std::string place = state_file == "-" ? "standard input" : state_file;
  for (size_t s = 0; s < states.size(); ++s) {
    const State& state = states[s];
    Eigen::MatrixXd result;
    if (batch) {
      result = batch->result(wanted, s);
    } else if (generated) {
      generated->evaluate(state);
      result = generated->result(wanted);
    } else {
      result = evaluate_generic(model, wanted, state);
    }
    check_finite_inputs(model, wanted, place, state, result.allFinite());
    if (!result.allFinite())
      warnings.push_back({Severity::warning, place, state.place, fmt::format("{} is not finite at this state", output),
                          "look for huge numbers on that line"});
    if (!text.empty()) text += '\n';
    append_rows(text, result);
  }
  return text;
}

}  // namespace dalembert
