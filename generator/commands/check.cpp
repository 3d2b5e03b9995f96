#include "commands/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "commands/batch_engine.hpp"
#include "commands/generated_engine.hpp"
#include "commands/generic_engine.hpp"
#include "commands/machine.hpp"
#include "commands/random_states.hpp"
#include "reference/engine.hpp"

namespace dalembert {

namespace {

// The largest difference relative to the largest element of the reference, over states. NaN counts as infinite.
class RelativeError {
 public:
  explicit RelativeError(double least_scale) : largest_(least_scale) {}
  void add(const Eigen::MatrixXd& value, const Eigen::MatrixXd& reference) {
    const double difference = (value - reference).cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
    difference_ = std::max(difference_, std::isnan(difference) ? std::numeric_limits<double>::infinity() : difference);
    largest_ = std::max(largest_, reference.cwiseAbs().maxCoeff());
  }
  double value() const { return difference_ == 0 ? 0 : difference_ / largest_; }

 private:
  double difference_ = 0, largest_;
};

struct References {
  std::vector<Eigen::MatrixXd> generic, multiprecision;  // per state
  double least_scale = 0;
  double tolerance = 0;
};

// Relative to the largest element; of what is solved for, as much more as M's condition magnifies rounding.
double tolerance(const Model& model, const Output& output, const std::vector<State>& states) {
  const bool single_precision = model.scene.scalar == ir::ScalarType::float32;
  double result = single_precision ? 1e-5 : 1e-12;
  for (const State& state : states) {
    const double condition = reference::condition({output.quantity, output.link, output.of_link}, model.tree, model.scene,
                                                  {state.q, state.v, state.more, state.wrenches});
    result = std::max(result, 10 * condition * (single_precision ? 0x1p-24 : 0x1p-53));
  }
  return result;
}

References references(const Model& model, const Output& output, const std::vector<State>& states) {
  References references;
  for (const State& state : states) {
    references.generic.push_back(evaluate_generic(model, output, state));
    references.multiprecision.push_back(evaluate_multiprecision(model, output, state));
    const reference::Inputs inputs{state.q, state.v, state.more, state.wrenches};
    references.least_scale =
        std::max(references.least_scale,
                 reference::LeastScale(model.tree, model.scene, inputs).of({output.quantity, output.link, output.of_link}));
  }
  references.tolerance = tolerance(model, output, states);
  return references;
}

}  // namespace

CheckReport check(const Model& model, const CompilerOptions& options) {
  const std::vector<Output> outputs = outputs_of(model);
  const std::vector<State> states = random_states(model.tree, 20);
  CheckReport report;
  report.text = fmt::format("{}: {} base, {} random states; errors relative to the largest element\n", model.name,
                            model.tree.floating_base ? "floating" : "fixed", states.size());
  report.text +=
      fmt::format("  {:<34}{:>16}{:>16}{:>16}{:>14}\n", "output", "to generic", "to 50 digits", "at most", "ns per call");

  // result_at: the number of a state → what is computed there.
  const auto compare_results = [&](const auto& result_at, const Output& output, const References& expected,
                                   const std::string& time) {
    RelativeError to_generic(expected.least_scale), to_multiprecision(expected.least_scale);
    for (size_t s = 0; s < states.size(); ++s) {
      const Eigen::MatrixXd result = result_at(s);
      to_generic.add(result, expected.generic[s]);
      to_multiprecision.add(result, expected.multiprecision[s]);
    }
    const bool good = to_generic.value() <= expected.tolerance && to_multiprecision.value() <= expected.tolerance;
    report.passed = report.passed && good;
    report.text += fmt::format("  {:<34}{:>16.2e}{:>16.2e}{:>16.2g}{:>14}{}\n", output.name, to_generic.value(),
                               to_multiprecision.value(), expected.tolerance, time, good ? "" : "  DIFFERS");
  };
  const auto compare = [&](GeneratedEngine& engine, const Output& output, const References& expected, const std::string& time) {
    compare_results(
        [&](size_t s) {
          engine.evaluate(states[s]);
          return engine.result(output);
        },
        output, expected, time);
  };

  std::string command;
  const auto run_self_test = [&](const GeneratedEngine& engine) {
    const std::string wrong = engine.self_test();
    report.passed = report.passed && wrong.empty();
    report.text += fmt::format("  {:<34}{}\n", "self-test", wrong.empty() ? "passes" : "FAILS: " + wrong);
    command = engine.command();
  };

  std::vector<References> expected;
  for (const Output& output : outputs) {
    expected.push_back(references(model, output, states));
    GeneratedEngine alone(model, {output}, options, outputs.size() == 1 ? Besides::self_test : Besides::nothing);
    compare(alone, output, expected.back(), fmt::format("{:.0f}", alone.time_per_call(states).median));
    if (outputs.size() == 1) run_self_test(alone);
  }
  if (outputs.size() > 1) {
    GeneratedEngine together(model, outputs, options, Besides::self_test);
    report.text +=
        fmt::format("  {:<34}{:>16}{:>16}{:>16}{:>14.0f}\n", "all together", "", "", "", together.time_per_call(states).median);
    for (size_t i = 0; i < outputs.size(); ++i) compare(together, outputs[i], expected[i], "");
    run_self_test(together);
  }
  if (model.scene.batch) {
    BatchEngine batch(model, outputs, options);
    batch.evaluate(states);
    report.text += fmt::format("  {:<34}{:>16}{:>16}{:>16}{:>14.0f}\n", "as a batch, per state", "", "", "",
                               batch.time_per_state(states));
    for (size_t i = 0; i < outputs.size(); ++i)
      compare_results([&](size_t s) { return batch.result(outputs[i], s); }, outputs[i], expected[i], "");
  }
  report.text += fmt::format("  compiled by {}\n  timed on {}\n", command, this_machine().text());
  return report;
}

}  // namespace dalembert
