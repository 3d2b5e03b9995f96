#include "commands/report/rounding.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <utility>

#include "commands/parallel.hpp"
#include "commands/random_states.hpp"
#include "commands/report/errors.hpp"
#include "commands/report/progress.hpp"
#include "commands/report/variants.hpp"
#include "commands/timing.hpp"
#include "costs.hpp"
#include "lower.hpp"

namespace dalembert::reporting {
namespace {

constexpr long long_straight_line = 10000;  // operations

// One point of the diagram of one output; the generic engine's is the first.
struct Point {
  std::string variant;
  ir::ScalarType scalar = ir::ScalarType::float64;
  std::function<Eigen::MatrixXd(const State&)> result;
  std::function<CallTime(const std::vector<State>&)> time_per_call;
  CallTime time{};
  std::vector<Error> errors{};  // per state
};

Point generic_point(const Subject& subject, const Output& output) {
  const auto result = [&](const State& state) { return generic_at(subject.model, {output}, state).front(); };
  return {generic_variant, ir::ScalarType::float64, result, [result](const std::vector<State>& states) {
            return time_calls(states.size(), [&](size_t s) { result(states[s]); });
          }};
}

Point generated_point(const Variant& way, GeneratedEngine& engine, const Output& output) {
  const auto result = [&](const State& state) {
    engine.evaluate(state);
    return engine.result(output);
  };
  return {way.name, way.scalar, result, [&](const std::vector<State>& states) { return engine.time_per_call(states); }};
}

Point mujoco_point(const Mujoco& mujoco, const Output& output) {
  return {mujoco_variant, ir::ScalarType::float64, [&](const State& state) { return mujoco.result(output, state); },
          [&](const std::vector<State>& states) { return mujoco.time_per_call(output, states); }};
}

Point pinocchio_point(const Pinocchio& pinocchio, const Output& output) {
  return {pinocchio_variant, ir::ScalarType::float64, [&](const State& state) { return pinocchio.result(output, state); },
          [&](const std::vector<State>& states) { return pinocchio.time_per_call(output, states); }};
}

// As many states as 50 digits get through in about a minute and a half of one core; at least fifty.
std::vector<State> states_of(const Subject& subject) {
  if (subject.quick) return random_states(subject.model.tree, 50);
  const std::vector<State> first = random_states(subject.model.tree, 3);
  const auto start = std::chrono::steady_clock::now();
  for (const State& state : first) exact_at(subject.model, subject.outputs, state);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / 3;
  return random_states(subject.model.tree, std::clamp(static_cast<int>(90 / seconds), 50, 10000));
}

// Engines write into their own workspaces: each is used by one thread. `points` per output.
void measure_errors(const Subject& subject, const std::vector<State>& given, ir::ScalarType scalar,
                    std::vector<std::vector<Point>>& points) {
  const bool single = scalar == ir::ScalarType::float32;
  if (std::none_of(points.begin(), points.end(), [&](const std::vector<Point>& own) {
        return std::any_of(own.begin(), own.end(), [&](const Point& point) { return point.scalar == scalar; });
      }))
    return;
  std::vector<State> states;
  for (const State& state : given) states.push_back(single ? rounded_to_float(state) : state);
  Progress progress(single ? "exact results for float" : "exact results", states.size());
  constexpr size_t at_once = 100;  // states whose exact results are held in memory
  for (size_t from = 0; from < states.size(); from += at_once) {
    const size_t count = std::min(at_once, states.size() - from);
    std::vector<Exact> exact(count);
    each_in_parallel(count, [&](size_t s) {
      exact[s] = exact_at(subject.model, subject.outputs, states[from + s]);
      progress.step();
    });
    for (size_t o = 0; o < subject.outputs.size(); ++o)
      for (Point& point : points[o]) {
        if (point.scalar != scalar) continue;
        for (size_t s = 0; s < count; ++s) {
          const Eigen::MatrixXd result = point.result(states[from + s]);
          point.errors.push_back(error_of(result, exact[s].results[o], exact[s].least_scales[o], scalar));
        }
      }
  }
}

Spread of(const std::vector<Error>& errors, double Error::*kind) {
  std::vector<double> values;
  for (const Error& error : errors) values.push_back(error.*kind);
  return spread(std::move(values));
}

void add_rows(const std::string& quantity, const std::vector<Point>& points, Rows& rows) {
  const auto worst = [](const Point& p) { return of(p.errors, &Error::norm).worst; };
  const auto point_of = [&](const char* variant) {
    return std::find_if(points.begin(), points.end(), [&](const Point& p) { return p.variant == variant; });
  };
  const auto mujoco = point_of(mujoco_variant), pinocchio = point_of(pinocchio_variant);
  for (const Point& point : points) {
    const auto add = [&](const char* metric, double value, const char* unit) {
      rows.number("rounding", random_case, quantity, point.variant, metric, value, unit);
    };
    add("time_median", point.time.median, "ns");
    add("time_lower_quartile", point.time.lower_quartile, "ns");
    add("time_upper_quartile", point.time.upper_quartile, "ns");
    add("times_faster", points.front().time.median / point.time.median, "times");
    if (mujoco != points.end()) add("times_faster_than_mujoco", mujoco->time.median / point.time.median, "times");
    if (pinocchio != points.end()) add("times_faster_than_pinocchio", pinocchio->time.median / point.time.median, "times");
    const Spread norm = of(point.errors, &Error::norm), ulp = of(point.errors, &Error::ulp),
                 component = of(point.errors, &Error::component);
    add("norm_lower_quartile", norm.lower_quartile, "1");
    add("norm_median", norm.median, "1");
    add("norm_upper_quartile", norm.upper_quartile, "1");
    add("norm_worst", norm.worst, "1");
    add("ulp_median", ulp.median, "ulp");
    add("ulp_worst", ulp.worst, "ulp");
    add("component_median", component.median, "1");
    add("component_worst", component.worst, "1");
    add("states", static_cast<double>(point.errors.size()), "states");
    const bool beaten = std::any_of(points.begin(), points.end(), [&](const Point& other) {
      return other.time.median <= point.time.median && worst(other) <= worst(point) &&
             (other.time.median < point.time.median || worst(other) < worst(point));
    });
    add("pareto", beaten ? 0 : 1, "1");
  }
}

}  // namespace

Rounding::Rounding(const Subject& subject) : subject_(subject) {
  for (const Output& output : subject.outputs) {
    const Lowered lowered = lower(with_outputs(subject.model, {output}));
    const ir::Form chosen = lowered.functions.front().first().plan.form;
    std::vector<Variant> ways = variants(chosen, subject.quick);
    if (subject.model.tree.bodies.empty()) std::erase_if(ways, [](const Variant& v) { return v.form == ir::Form::rolled; });
    // A long straight line takes a compiler longer than all the rest of a quick report.
    const long operations = operation_costs(lowered, subject.model.tree).front().operations.total();
    if (subject.quick && operations > long_straight_line)
      std::erase_if(ways, [&](const Variant& v) { return v.form != chosen; });
    if (subject.many_outputs()) ways = {plain(ways, chosen, ir::ScalarType::float64)};
    chosen_.push_back(plain(ways, chosen, ir::ScalarType::float64).name);
    ways_.push_back(std::move(ways));
  }
}

std::vector<Order> Rounding::orders() const {
  std::vector<Order> list;
  for (size_t o = 0; o < ways_.size(); ++o)
    for (const Variant& way : ways_[o])
      list.push_back({model_of(subject_.model, way), {subject_.outputs[o]}, options_of(subject_.compiler, way)});
  return list;
}

void Rounding::add(std::span<const std::unique_ptr<GeneratedEngine>> engines, Rows& rows) const {
  const Subject& subject = subject_;
  for (size_t o = 0; o < subject.outputs.size(); ++o)
    rows.text("rounding", random_case, subject.outputs[o].name, chosen_[o], "chosen", "yes");
  std::vector<std::vector<Point>> points(subject.outputs.size());
  for (size_t o = 0, next = 0; o < subject.outputs.size(); ++o) {
    const Output& output = subject.outputs[o];
    points[o].push_back(generic_point(subject, output));
    for (const Variant& way : ways_[o]) points[o].push_back(generated_point(way, *engines[next++], output));
    const auto add_peer = [&](const auto& peer, const char* variant, const auto& point) {
      if (!peer.found()) return;
      const std::string obstacle = peer.obstacle(output);
      if (obstacle.empty()) points[o].push_back(point(peer, output));
      else rows.text("rounding", random_case, output.name, variant, "left_out", obstacle);
    };
    add_peer(subject.mujoco, mujoco_variant, mujoco_point);
    add_peer(subject.pinocchio, pinocchio_variant, pinocchio_point);
  }
  const std::vector<State> states = states_of(subject);
  measure_errors(subject, states, ir::ScalarType::float64, points);
  measure_errors(subject, {states.begin(), states.begin() + static_cast<std::ptrdiff_t>(std::min<size_t>(states.size(), 1000))},
                 ir::ScalarType::float32, points);

  const std::vector<State> timed(states.begin(), states.begin() + 20);
  size_t count = 0;
  for (const std::vector<Point>& own : points) count += own.size();
  Progress progress("timing", count);
  for (size_t o = 0; o < points.size(); ++o) {
    for (Point& point : points[o]) {
      point.time = point.time_per_call(timed);
      progress.step();
    }
    add_rows(subject.outputs[o].name, points[o], rows);
  }
}

}  // namespace dalembert::reporting
