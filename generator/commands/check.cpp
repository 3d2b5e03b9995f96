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

// The outputs that one piece of code computes: each of the standard functions' alone, and those of a function that the scene
// names together, since a call gives them all.
std::vector<std::vector<size_t>> pieces(const std::vector<Output>& outputs) {
  std::vector<std::vector<size_t>> pieces;
  for (size_t o = 0; o < outputs.size(); ++o) {
    const auto of_same = [&](const std::vector<size_t>& piece) {
      const Output& other = outputs[piece.front()];
      return outputs[o].function.named && other.function.named && other.function.name == outputs[o].function.name;
    };
    const auto found = std::find_if(pieces.begin(), pieces.end(), of_same);
    if (found == pieces.end()) pieces.push_back({o});
    else found->push_back(o);
  }
  return pieces;
}

class Check {
 public:
  Check(const Model& model, const CompilerOptions& options)
      : model_(model), options_(options), outputs_(outputs_of(model)), states_(random_states(model.tree, 20)) {}

  CheckReport run() {
    report_.text = fmt::format("{}: {} base, {} random states; errors relative to the largest element\n", model_.name,
                               model_.tree.floating_base ? "floating" : "fixed", states_.size());
    for (const Output& output : outputs_) expected_.push_back(references(model_, output, states_));
    const std::vector<std::vector<size_t>> all = pieces(outputs_);
    const bool one = all.size() == 1;
    heading(one ? "its code" : "each by code of its own");
    for (const std::vector<size_t>& piece : all) {
      std::vector<Output> own;
      for (const size_t o : piece) own.push_back(outputs_[o]);
      GeneratedEngine alone(model_, own, options_, one ? Besides::self_test : Besides::nothing);
      const bool line_of_its_own = own.size() > 1;
      const std::string time = line_of_its_own ? "" : time_text(alone.time_per_call(states_).median);
      for (const size_t o : piece) compare(alone, o, time);
      if (line_of_its_own) function_lines(alone.time_per_function(states_));
      if (one) run_self_test(alone);
    }
    if (!one) {
      GeneratedEngine together(model_, outputs_, options_, Besides::self_test);
      heading("all by one code");
      for (size_t o = 0; o < outputs_.size(); ++o) compare(together, o, "");
      function_lines(together.time_per_function(states_));
      run_self_test(together);
    }
    if (model_.scene.batch) batch();
    report_.text += fmt::format("  compiled by {}\n  timed on {}\n", command_, this_machine().text());
    return std::move(report_);
  }

 private:
  void line(const std::string& what, const std::string& errors, const std::string& time, const char* mark = "") {
    std::string text = fmt::format("  {:<34}{:>40}{:>12}", what, errors, time);
    text.erase(text.find_last_not_of(' ') + 1);
    report_.text += text + mark + "\n";
  }
  void heading(const std::string& what) {
    report_.text += "\n";
    line(what, fmt::format("{:>14}{:>14}{:>12}", "to generic", "to 50 digits", "at most"), "a call");
  }
  void function_lines(const std::vector<GeneratedEngine::FunctionTime>& times) {
    for (const auto& [function, time] : times) line(function + "()", "", time_text(time.median));
  }

  // result_at: the number of a state → what is computed there.
  template <class ResultAt>
  void compare_results(const ResultAt& result_at, size_t o, const std::string& time) {
    const References& expected = expected_[o];
    RelativeError to_generic(expected.least_scale), to_multiprecision(expected.least_scale);
    for (size_t s = 0; s < states_.size(); ++s) {
      const Eigen::MatrixXd result = result_at(s);
      to_generic.add(result, expected.generic[s]);
      to_multiprecision.add(result, expected.multiprecision[s]);
    }
    const bool good = to_generic.value() <= expected.tolerance && to_multiprecision.value() <= expected.tolerance;
    report_.passed = report_.passed && good;
    line(outputs_[o].name,
         fmt::format("{:>14.2e}{:>14.2e}{:>12.2g}", to_generic.value(), to_multiprecision.value(), expected.tolerance), time,
         good ? "" : "  DIFFERS");
  }
  void compare(GeneratedEngine& engine, size_t o, const std::string& time) {
    compare_results(
        [&](size_t s) {
          engine.evaluate(states_[s]);
          return engine.result(outputs_[o]);
        },
        o, time);
  }

  void batch() {
    BatchEngine batch(model_, outputs_, options_);
    batch.evaluate(states_);
    heading("all as a batch");
    for (size_t o = 0; o < outputs_.size(); ++o) compare_results([&](size_t s) { return batch.result(outputs_[o], s); }, o, "");
    line("a state", "", time_text(batch.time_per_state(states_)));
  }

  void run_self_test(const GeneratedEngine& engine) {
    const std::string wrong = engine.self_test();
    report_.passed = report_.passed && wrong.empty();
    report_.text += fmt::format("\n  {:<34}{}\n", "self-test", wrong.empty() ? "passes" : "FAILS: " + wrong);
    command_ = engine.command();
  }

  const Model& model_;
  const CompilerOptions& options_;
  std::vector<Output> outputs_;
  std::vector<State> states_;
  std::vector<References> expected_;
  CheckReport report_;
  std::string command_;
};

}  // namespace

CheckReport check(const Model& model, const CompilerOptions& options) { return Check(model, options).run(); }

}  // namespace dalembert
