#include "commands/measure_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <new>
#include <vector>

#include "commands/random_states.hpp"
#include "commands/timing.hpp"
#include "frontend/text_file.hpp"
#include "frontend/yaml_text.hpp"
#include "ir/emitted_function.hpp"
#include "ir/plan_words.hpp"
#include "lower.hpp"

namespace dalembert {
namespace {

// Of estimates, which err by some tens of percent.
constexpr double worth_measuring = 2;
// A way that is not faster by more than clocks tell apart does not displace the one that is estimated to be the fastest.
constexpr double told_apart = 0.98;
constexpr int states = 16, most_rounds = 101, fewest_rounds = 11;
constexpr double most_time = 1.5e9;  // ns, of one function

using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) { return std::chrono::duration<double, std::nano>(Clock::now() - start).count(); }

struct Way {
  ir::FunctionPlan plan;
  double nanoseconds = 0;
};

struct Measured {
  ir::EmittedFunction function;
  std::vector<Way> ways;  // the one of the best estimate first
};

// The ways to compute a function that are worth a try.
std::vector<Way> ways_of(const LoweredFunction& function) {
  std::vector<Way> ways;
  const std::vector<Candidate>& candidates = function.candidates;
  const bool solves = std::any_of(candidates.begin(), candidates.end(),
                                  [&](const Candidate& c) { return c.solver != candidates.front().solver; });
  const auto best = [](const Candidate& c) { return *std::min_element(c.nanoseconds.begin(), c.nanoseconds.end()); };
  for (const Candidate& c : candidates) {
    if (best(c) > worth_measuring * best(candidates.front())) continue;
    ir::FunctionPlan plan;
    plan.form = c.form;
    if (solves) plan.solver = c.solver;
    if (c.form == ir::Form::rolled) {
      ways.push_back({plan});
      continue;
    }
    for (const auto& [word, order] : ir::order_words()) {
      plan.order = order;
      ways.push_back({plan});
    }
  }
  return ways;
}

// The whole robot with each function in one of its ways, as code in this process.
class Variant {
 public:
  Variant(const Model& model, const std::vector<Measured>& functions, std::size_t way, const CompilerOptions& options)
      : name_(model.name),
        code_(name_, compile_without_self_test(planned(model, functions, way)), options),
        workspace_(code_.function<void*()>(name_ + "_create")(), code_.function<void(void*)>(name_ + "_destroy")) {
    if (!workspace_) throw std::bad_alloc();
  }

  void* function(const std::string& name) const { return reinterpret_cast<void*>(code_.function<void()>(name_ + "_" + name)); }
  void* workspace() const { return workspace_.get(); }
  const std::string& command() const { return code_.command(); }

 private:
  static Model planned(Model model, const std::vector<Measured>& functions, std::size_t way) {
    model.scene.plan.clear();
    for (const Measured& f : functions) model.scene.plan[f.function.name] = f.ways[std::min(way, f.ways.size() - 1)].plan;
    return model;
  }

  std::string name_;
  LoadedCode code_;
  std::unique_ptr<void, void (*)(void*)> workspace_;
};

template <class Scalar>
class Timing {
 public:
  explicit Timing(const Model& model) {
    for (const State& state : random_states(model.tree, states)) {
      q_.push_back(state.q.cast<Scalar>());
      v_.push_back(state.v.cast<Scalar>());
      more_.push_back(state.more.cast<Scalar>());
    }
  }

  // Lower quartiles of the times of a call, way by way.
  void run(Measured& f, const std::vector<std::unique_ptr<Variant>>& variants) const {
    std::vector<std::vector<double>> times(f.ways.size());
    const Clock::time_point start = Clock::now();
    for (int round = 0; round < most_rounds && (round < fewest_rounds || since(start) < most_time); ++round)
      for (std::size_t way = 0; way < f.ways.size(); ++way) {
        turn(f, *variants[way]);  // what it reads is in the caches, as in a loop
        const Clock::time_point begun = Clock::now();
        turn(f, *variants[way]);
        times[way].push_back(since(begun) / states);
      }
    for (std::size_t way = 0; way < f.ways.size(); ++way) {
      const auto quartile = times[way].begin() + static_cast<std::ptrdiff_t>(times[way].size() / 4);
      std::nth_element(times[way].begin(), quartile, times[way].end());
      f.ways[way].nanoseconds = *quartile;
    }
  }

 private:
  void turn(const Measured& f, const Variant& variant) const {
    using V = const Scalar*;
    void* const function = variant.function(f.function.name);
    for (std::size_t s = 0; s < q_.size(); ++s) {
      if (*f.function.input() != 0)
        reinterpret_cast<void (*)(V, V, V, void*)>(function)(q_[s].data(), v_[s].data(), more_[s].data(), variant.workspace());
      else reinterpret_cast<void (*)(V, V, void*)>(function)(q_[s].data(), v_[s].data(), variant.workspace());
    }
  }

  std::vector<Eigen::VectorX<Scalar>> q_, v_, more_;
};

std::string described(const ir::FunctionPlan& plan) {
  std::string text = word_of(ir::form_words(), *plan.form);
  if (plan.solver) text += " by " + word_of(ir::solver_words(), *plan.solver);
  if (plan.order) text += ", " + word_of(ir::order_words(), *plan.order);
  return text;
}

}  // namespace

MeasuredPlan measure_plan(const Model& asked, const CompilerOptions& options) {
  Model model = asked;
  model.scene.plan.clear();
  std::vector<Measured> functions;
  for (const LoweredFunction& f : lower(model).functions)
    if (const std::vector<Way> ways = ways_of(f); ways.size() > 1) functions.push_back({f.first().algorithm.function, ways});
  std::size_t count = 0;
  for (const Measured& f : functions) count = std::max(count, f.ways.size());
  std::vector<std::unique_ptr<Variant>> variants;
  for (std::size_t way = 0; way < count; ++way) variants.push_back(std::make_unique<Variant>(model, functions, way, options));
  MeasuredPlan measured;
  if (functions.empty()) return {{}, "plan: no function can be computed in more than one way\n"};
  measured.text = fmt::format("measured time of a call, compiled by {}:\n", variants.front()->command());
  for (Measured& f : functions) {
    if (model.scene.scalar == ir::ScalarType::float32) Timing<float>(model).run(f, variants);
    else Timing<double>(model).run(f, variants);
    std::size_t chosen = 0;
    for (std::size_t way = 1; way < f.ways.size(); ++way)
      if (f.ways[way].nanoseconds < f.ways[chosen].nanoseconds * (chosen == 0 ? told_apart : 1)) chosen = way;
    measured.plan[f.function.name] = f.ways[chosen].plan;
    measured.text += fmt::format("  {}\n", f.function.name);
    for (std::size_t way = 0; way < f.ways.size(); ++way)
      measured.text += fmt::format("    {:<50}{:>10}{}\n", described(f.ways[way].plan), time_text(f.ways[way].nanoseconds),
                                   way == chosen ? "  chosen" : "");
  }
  return measured;
}

bool asks_to_measure(const Request& request) {
  return std::any_of(request.settings.begin(), request.settings.end(),
                     [](const frontend::Setting& s) { return s.key == "plan" && s.text == "measure"; });
}

Request with_measured_plan(Request request, const CompilerOptions& options, std::string& told) {
  const auto is_plan = [](const frontend::Setting& s) { return s.key == "plan"; };
  std::erase_if(request.settings, is_plan);
  // Without the plan that the file has: it may be one for other outputs.
  Request unplanned = request;
  unplanned.settings.push_back({"plan", "{}"});
  Diagnostics said_again;
  const Model model = read_model(unplanned, said_again);
  if (!model.tree.linkages.empty())
    throw InputError({Severity::error, "", "plan",
                      fmt::format("loop '{}' is embedded, and what its functions are made of is not measured one by one",
                                  model.tree.linkages.front().loops.front().name),
                      "leave plan: measure out"});
  std::string before;
  if (!request.scene_file.empty()) {
    before = frontend::read_text_file(request.scene_file, "scene", frontend::yaml_bytes);
    frontend::with_plan(request.scene_file, before, {{"evaluate", {}}});  // refuses before minutes of work
  }
  const MeasuredPlan measured = measure_plan(model, options);
  told = measured.text;
  if (measured.plan.empty()) return request;
  if (request.scene_file.empty()) {
    request.settings.push_back({"plan", frontend::plan_setting(measured.plan)});
    told += "to be kept in a scene file:\n" + frontend::plan_lines(measured.plan);
    return request;
  }
  const std::filesystem::path path = request.scene_file;
  backend::add_files(path.has_parent_path() ? path.parent_path().string() : ".",
                     {{path.filename().string(), frontend::with_plan(request.scene_file, before, measured.plan)}});
  told += fmt::format("written into {}:\n{}", request.scene_file, frontend::plan_lines(measured.plan));
  return request;
}

}  // namespace dalembert
