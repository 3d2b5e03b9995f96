#include "commands/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <dalembert/integrators/linearly_implicit.hpp>
#include <dalembert/integrators/rk4.hpp>
#include <dalembert/integrators/semi_implicit_euler.hpp>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "commands/batch_engine.hpp"
#include "commands/generated_engine.hpp"
#include "commands/generic_engine.hpp"
#include "commands/machine.hpp"
#include "commands/parallel.hpp"
#include "commands/precompiled_eigen.hpp"
#include "commands/random_states.hpp"
#include "ir/implicit_joints.hpp"
#include "reference/eigenvalues.hpp"
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
  double tolerance = 0;          // against 50 digits
  double generic_tolerance = 0;  // against the generic engine, which computes in double too and loses digits of its own
};

// Relative to the largest element; of what is solved for, as much more as M's condition magnifies rounding. Single precision
// is allowed eight times what the generic engine loses in it, too (references).
double tolerance(const Model& model, const Output& output, const std::vector<State>& states) {
  const bool single_precision = model.scene.scalar == ir::ScalarType::float32;
  double result = single_precision ? 1e-5 : 1e-12;
  for (const State& state : states) {
    const double condition =
        reference::condition({output.quantity, output.link, output.of_link}, model.tree, model.scene, inputs(state));
    if (std::isnan(condition)) return std::numeric_limits<double>::infinity();
    result = std::max(result, 10 * condition * (single_precision ? 0x1p-24 : 0x1p-53));
  }
  return result;
}

References references(const Model& model, const Output& output, const std::vector<State>& states) {
  References references;
  for (const State& state : states) {
    references.generic.push_back(evaluate_generic(model, output, state));
    references.multiprecision.push_back(evaluate_multiprecision(model, output, state));
    const reference::Inputs at = inputs(state);
    references.least_scale =
        std::max(references.least_scale, reference::LeastScale(model.tree, model.scene, at)
                                             .of({output.quantity, output.link, output.of_link, output.selection()}));
  }
  references.tolerance = tolerance(model, output, states);
  if (model.scene.scalar == ir::ScalarType::float32) {
    // A thousandth of the terms that cancel, times 1e-12, is nine roundings of theirs; times 1e-5 it were a sixth of one.
    references.least_scale *= 54;
    // In single precision terms that cancel soon leave less than the fixed share: the generic engine says what they do here.
    RelativeError generic(references.least_scale);
    for (size_t s = 0; s < states.size(); ++s)
      generic.add(evaluate_single_precision(model, output, states[s]), references.multiprecision[s]);
    if (std::isfinite(generic.value())) references.tolerance = std::max(references.tolerance, 8 * generic.value());
  }
  RelativeError of_generic(references.least_scale);
  for (size_t s = 0; s < states.size(); ++s) of_generic.add(references.generic[s], references.multiprecision[s]);
  references.generic_tolerance = references.tolerance + std::min(of_generic.value(), 8 * references.tolerance);
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

// What the integrators ask of the generic engine.
class GenericDynamics {
 public:
  std::vector<QuaternionJoint> quaternion_joints;

  GenericDynamics(const Model& model, const Output& output, const State& state)
      : quaternion_joints(model.tree.quaternion_joints()), model_(model), output_(output), at_(state) {}

  Eigen::VectorXd acceleration(const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
    at_.q = q, at_.v = v;
    return evaluate_generic(model_, output_, at_);
  }

  // With the joints' own dampers and springs alone, C being held during a step.
  integrators::Linearised<double, Eigen::Dynamic> linearised(const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
    const Eigen::VectorXd at_rest = Eigen::VectorXd::Zero(v.size());
    const std::vector<Eigen::MatrixXd> of_motion =
        reference::evaluate(model_.tree, model_.scene, {{ir::Quantity::mass_matrix, ""}, {ir::Quantity::inverse_dynamics, ""}},
                            {q, v, at_rest, at_.wrenches}, reference::Precision::float64);
    integrators::Linearised<double, Eigen::Dynamic> near;
    near.mass = of_motion[0];
    near.damping = near.stiffness = Eigen::MatrixXd::Zero(v.size(), v.size());
    for (const ir::ImplicitJoint& joint : ir::implicit_joints(model_.tree)) {
      near.damping(joint.coordinate, joint.coordinate) = joint.damping;
      near.stiffness(joint.coordinate, joint.coordinate) = joint.stiffness;
    }
    near.force = at_.more - of_motion[1];
    return near;
  }

 private:
  const Model& model_;
  const Output& output_;
  State at_;
};

class Check {
 public:
  Check(const Model& model, const CompilerOptions& options, Pieces which)
      : model_(model), options_(options), which_(which), outputs_(outputs_of(model)), states_(random_states(model.tree, 20)) {
    for (unsigned s = 1; s < states_.size(); s += 2) {
      if (model.scene.constraint_rows() > 0) states_[s].acting = random_acting(model.scene, s);
      states_[s].loading = random_loading(model.tree, model.scene, s);
    }
  }

  CheckReport run() {
    report_.text = fmt::format("{}: {} base, {} random states{}; errors relative to the largest element\n", model_.name,
                               ir::row_of(model_.tree.base_joint).word, states_.size(), of_half_of_them());
    for (const Output& output : outputs_) expected_.push_back(references(model_, output, states_));
    std::vector<std::vector<size_t>> all = pieces(outputs_);
    const bool one = all.size() == 1;
    if (!one && which_ == Pieces::together) all.clear();
    const Engines engines = compiled(all, one);
    if (!all.empty()) heading(one ? "its code" : "each by code of its own");
    for (size_t p = 0; p < all.size(); ++p) {
      GeneratedEngine& alone = *engines.single[p];
      const bool line_of_its_own = all[p].size() > 1;
      const std::string time = line_of_its_own ? "" : time_text(alone.time_per_call(states_).median);
      for (const size_t o : all[p]) compare(alone, o, time);
      if (line_of_its_own) function_lines(alone.time_per_function(states_));
      if (one) run_self_test(alone);
    }
    if (GeneratedEngine* const together = engines.together.get()) {
      heading("all by one code");
      for (size_t o = 0; o < outputs_.size(); ++o) compare(*together, o, "");
      function_lines(together->time_per_function(states_));
      run_self_test(*together);
    }
    if (engines.batch) batch(*engines.batch);
    if (not_told_) report_.text += fmt::format("\n  not told: {}\n", not_told_because());
    report_.text += fmt::format("  compiled by {}\n  timed on {}\n", command_, this_machine().text());
    return std::move(report_);
  }

 private:
  std::string of_half_of_them() const {
    std::vector<std::string> what;
    if (!model_.scene.payloads.empty()) what.push_back("payloads");
    if (model_.scene.gravity_kind == ir::GravityKind::run_time) what.push_back("gravity of any direction");
    if (model_.scene.constraint_rows() > 0) what.push_back("some contacts or loops off or giving way");
    return what.empty() ? "" : fmt::format(", in half of them {}", fmt::join(what, ", "));
  }

  struct Engines {
    std::vector<std::unique_ptr<GeneratedEngine>> single;  // a piece's
    std::unique_ptr<GeneratedEngine> together;             // where one piece is not all
    std::unique_ptr<BatchEngine> batch;                    // where the scene has one
  };

  // All that is run, compiled on all cores; the longest first. `one`: one piece is all.
  Engines compiled(const std::vector<std::vector<size_t>>& pieces, bool one) const {
    constexpr size_t repaid = 4;  // as many runs of the compiler as making the header takes the time of
    std::optional<PrecompiledEigen> eigen;
    if (pieces.size() >= repaid) eigen.emplace(options_);
    const CompilerOptions& options = eigen ? eigen->options() : options_;
    Engines engines;
    engines.single.resize(pieces.size());
    std::vector<std::function<void()>> work;
    if (model_.scene.batch) work.push_back([&] { engines.batch = std::make_unique<BatchEngine>(model_, outputs_, options); });
    if (!one)
      work.push_back(
          [&] { engines.together = std::make_unique<GeneratedEngine>(model_, outputs_, options, Besides::self_test); });
    for (size_t p = 0; p < pieces.size(); ++p)
      work.push_back([&, p] {
        std::vector<Output> own;
        for (const size_t o : pieces[p]) own.push_back(outputs_[o]);
        engines.single[p] =
            std::make_unique<GeneratedEngine>(model_, own, options, one ? Besides::self_test : Besides::nothing);
      });
    each_in_parallel(work.size(), [&](size_t i) { work[i](); });
    return engines;
  }

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

  std::string not_told_because() const {
    return fmt::format("what rounding does may be as large as the result, for at these states {}",
                       model_.tree.constraint_rows > 0
                           ? "rows of contacts or loops say nearly the same, or M is nearly singular"
                           : "M is nearly singular");
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
    const bool good = to_generic.value() <= expected.generic_tolerance && to_multiprecision.value() <= expected.tolerance;
    const bool told = expected.tolerance < 1;
    report_.passed = report_.passed && good;
    not_told_ = not_told_ || !told;
    line(outputs_[o].name,
         fmt::format("{:>14.2e}{:>14.2e}{:>12.2g}", to_generic.value(), to_multiprecision.value(), expected.tolerance), time,
         !good                                     ? "  DIFFERS"
         : !told                                   ? "  not told"
         : to_generic.value() > expected.tolerance ? "  the generic engine is off"
                                                   : "");
  }
  void compare(GeneratedEngine& engine, size_t o, const std::string& time) {
    compare_results(
        [&](size_t s) {
          engine.evaluate(states_[s]);
          return engine.result(outputs_[o]);
        },
        o, time);
  }

  void batch(BatchEngine& batch) {
    batch.evaluate(states_);
    heading("all as a batch");
    for (size_t o = 0; o < outputs_.size(); ++o) compare_results([&](size_t s) { return batch.result(outputs_[o], s); }, o, "");
    line("a state", "", time_text(batch.time_per_state(states_)));
    const std::vector<Output> moving = batch.accelerations();
    if (!moving.empty()) heading("its rollouts, 4 steps");
    for (const Output& output : moving) rollouts(batch, output);
  }

  // Motions of a few steps, beside the integrators' with the generic engine's accelerations: by how far the changes of v, and
  // where q ends, differ.
  void rollouts(BatchEngine& batch, const Output& output) {
    constexpr size_t steps = 4;
    size_t o = 0;
    while (outputs_[o].name != output.name) ++o;
    double fastest = 0;
    for (const Eigen::MatrixXd& acceleration : expected_[o].generic)
      if (acceleration.allFinite()) fastest = std::max(fastest, acceleration.cwiseAbs().maxCoeff());
    const double explicit_step = 0.05 / (1 + fastest);  // so that nothing grows beyond what the tolerance is for
    std::vector<std::pair<RolloutMethod, const char*>> methods{{RolloutMethod::semi_implicit_euler, "Euler"},
                                                               {RolloutMethod::rk4, "rk4"}};
    if (model_.scene.linearly_implicit) methods.emplace_back(RolloutMethod::linearly_implicit, "implicit");
    for (const auto& [method, name] : methods) {
      const bool implicit = method == RolloutMethod::linearly_implicit;
      const double time_step = implicit ? implicit_step(output) : explicit_step;
      const double tolerance =
          steps * (implicit ? std::max(expected_[o].tolerance, implicit_tolerance(output, time_step)) : expected_[o].tolerance);
      // In which all constraints act, and nothing is carried.
      std::vector<State> starts = states_;
      for (State& start : starts) start.acting = {}, start.loading = {};
      const BatchEngine::Ends ends = batch.roll_out(output, starts, steps, time_step, method);
      // Accelerations that vanish are measured against what cancels in them.
      RelativeError turned(static_cast<double>(steps) * time_step * expected_[o].least_scale), moved(1);
      bool all_moved = true;
      for (size_t s = 0; s < states_.size(); ++s) {
        GenericDynamics dynamics(model_, output, starts[s]);
        Eigen::VectorXd q = states_[s].q, v = states_[s].v;
        for (size_t step = 0; step < steps; ++step) {
          if (method == RolloutMethod::rk4) integrators::rk4(dynamics, time_step, q, v);
          else if (implicit) integrators::linearly_implicit(dynamics, time_step, q, v);
          else integrators::semi_implicit_euler(dynamics, time_step, q, v);
        }
        all_moved = all_moved && ends.stopped[s] < 0;
        turned.add(ends.v[s] - states_[s].v, v - states_[s].v);
        moved.add(ends.q[s], q);
      }
      const double error = std::max(turned.value(), moved.value());
      // Where rounding may be all of it, it may be what a status stops a motion for.
      const bool told = expected_[o].tolerance < 1, good = !told || (all_moved && error <= tolerance);
      report_.passed = report_.passed && good;
      not_told_ = not_told_ || !told;
      line(fmt::format("{}, {}", output.function.named ? output.function.name : output.name, name),
           fmt::format("{:>14.2e}{:>14}{:>12.2g}", error, "", tolerance), "", good ? (told ? "" : "  not told") : "  DIFFERS");
    }
  }

  // The largest step, of 10 ms and quarters of it, in which v changes by little: what is stiff then comes to rest within steps,
  // where explicit ones have to be short for it.
  double implicit_step(const Output& output) const {
    double step = 1e-2;
    for (const State& state : states_) {
      GenericDynamics dynamics(model_, output, state);
      const auto change = [&] {
        Eigen::VectorXd q = state.q, v = state.v;
        integrators::linearly_implicit(dynamics, step, q, v);
        const double largest = (v - state.v).cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
        return std::isfinite(largest) ? largest : 0;
      };
      while (step > 1e-9 && change() > 2) step /= 4;
    }
    return step;
  }

  // As tolerance(), of what such a step solves with.
  double implicit_tolerance(const Output& output, double step) const {
    double result = 0;
    for (const State& state : states_) {
      GenericDynamics dynamics(model_, output, state);
      const auto near = dynamics.linearised(state.q, state.v);
      const Eigen::MatrixXd system = near.mass + step * near.damping + (step * step) * near.stiffness;
      const Eigen::VectorXd values = reference::eigenvalues(system);
      const double epsilon = model_.scene.scalar == ir::ScalarType::float32 ? 0x1p-24 : 0x1p-53;
      result = std::max(result, 10 * epsilon * values.maxCoeff() / values.minCoeff());
    }
    return result;
  }

  void run_self_test(const GeneratedEngine& engine) {
    const std::string wrong = engine.self_test();
    report_.passed = report_.passed && wrong.empty();
    report_.text += fmt::format("\n  {:<34}{}\n", "self-test", wrong.empty() ? "passes" : "FAILS: " + wrong);
    command_ = engine.command();
  }

  const Model& model_;
  const CompilerOptions& options_;
  Pieces which_;
  std::vector<Output> outputs_;
  std::vector<State> states_;
  std::vector<References> expected_;
  CheckReport report_;
  bool not_told_ = false;  // of some output, whether it is right
  std::string command_;
};

}  // namespace

CheckReport check(const Model& model, const CompilerOptions& options, Pieces which) {
  return Check(model, options, which).run();
}

}  // namespace dalembert
