#include "commands/report/stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <set>
#include <utility>

#include "commands/parallel.hpp"
#include "commands/random_states.hpp"
#include "commands/report/errors.hpp"
#include "commands/report/extreme_states.hpp"
#include "commands/report/rounding.hpp"
#include "commands/report/variants.hpp"
#include "costs.hpp"
#include "reference/eigenvalues.hpp"

namespace dalembert::reporting {
namespace {

constexpr double good_ulp = 32, weak_over_good = 128;
constexpr double heavy = 1e4;  // payload over the robot's own mass

const char* verdict_of(double over_limit) { return over_limit <= 1 ? good : over_limit <= weak_over_good ? weak : bad; }

// All outputs by the code users get, in one scalar.
struct Code {
  const char* name;
  ir::ScalarType scalar;
  GeneratedEngine* engine;

  std::vector<Eigen::MatrixXd> results(const std::vector<Output>& outputs, const State& state) const {
    engine->evaluate(state);
    std::vector<Eigen::MatrixXd> list;
    for (const Output& output : outputs) list.push_back(engine->result(output));
    return list;
  }
  State given(const State& state) const { return scalar == ir::ScalarType::float32 ? rounded_to_float(state) : state; }
};

class Stability {
 public:
  Stability(const Subject& subject, Rows& rows)
      : subject_(subject), rows_(rows), states_(random_states(subject.model.tree, subject.quick ? 5 : 50)) {
    const Lowered lowered = lower_to_programs(subject.model);
    costs_ = operation_costs(lowered, subject.model.tree);
    for (const LoweredFunction& function : lowered.functions)
      if (const ir::Algorithm& algorithm = function.first().algorithm; algorithm.guard)
        for (int array : algorithm.guard->arrays) solving_.insert(algorithm.arrays[static_cast<size_t>(array)].name);
  }

  // The model whose exact results are those of the state.
  using ModelAt = std::function<std::shared_ptr<const Model>(const State& state)>;

  void measured(const std::string& name, const Model& model, const std::vector<State>& states, const Code& code) {
    measured(name, model, states, code, outputs());
  }
  void measured(const std::string& name, const Model& model, const std::vector<State>& states, const Code& code,
                const std::vector<Output>& outputs) {
    const auto same = std::make_shared<const Model>(model);
    measured(name, {[&](const State&) { return same; }}, states, code, outputs);
  }
  // Where several models are as right, the one that comes closest counts, for each state and output.
  void measured(const std::string& name, const std::vector<ModelAt>& models, const std::vector<State>& states, const Code& code,
                const std::vector<Output>& outputs) {
    struct Judged {
      std::shared_ptr<const Model> model;
      Exact exact;
    };
    std::vector<Judged> judged(states.size() * models.size());
    each_in_parallel(judged.size(), [&](size_t i) {
      const State given = code.given(states[i / models.size()]);
      judged[i].model = models[i % models.size()](given);
      judged[i].exact = exact_at(*judged[i].model, outputs, given);
    });
    struct Worst {
      double ulp = 0, over_limit = 0, limit = 0;
      bool defined = false, reported = false;
    };
    std::vector<Worst> worst(outputs.size());
    for (size_t s = 0; s < states.size(); ++s) {
      const std::vector<Eigen::MatrixXd> results = code.results(outputs, states[s]);
      for (size_t o = 0; o < results.size(); ++o) {
        const Judged* nearest = nullptr;
        double ulp = 0;
        for (size_t m = 0; m < models.size(); ++m) {
          const Judged& one = judged[s * models.size() + m];
          const double own = error_of(results[o], one.exact.results[o], one.exact.least_scales[o], code.scalar).ulp;
          if (std::isnan(own) || (nearest && own >= ulp)) continue;
          nearest = &one;
          ulp = own;
        }
        if (!nearest) continue;
        worst[o].defined = true;
        worst[o].ulp = std::max(worst[o].ulp, ulp);
        if (solves_with_mass(outputs[o].name) && code.engine->status(outputs[o]) >= 0) {
          worst[o].reported = true;
          continue;
        }
        const double allowed = limit(*nearest->model, outputs[o], code.given(states[s]));
        if (ulp / allowed < worst[o].over_limit) continue;
        worst[o].over_limit = ulp / allowed;
        worst[o].limit = allowed;
      }
    }
    for (size_t o = 0; o < worst.size(); ++o)
      if (worst[o].defined) {
        const char* verdict = verdict_of(worst[o].over_limit);
        judge(name, outputs[o].name, code, "ulp_worst", worst[o].ulp, "ulp",
              worst[o].reported && verdict == good ? weak : verdict, [&] {
                const double allowed = worst[o].limit * weak_over_good, times = worst[o].over_limit / weak_over_good;
                more(name, outputs[o].name, code, "ulp_allowed", allowed, "ulp");
                if (!std::isfinite(times)) return std::string("not finite where the exact result is");
                more(name, outputs[o].name, code, "times_allowed", times, "1");
                return fmt::format("{:.3g} times as far from the exact result as the {:g} ulp that may be", times, allowed);
              });
      }
  }

  void extremes(const Code& code) {
    for (const ExtremeCase& extreme : extreme_cases()) {
      std::vector<State> states = states_;
      for (State& state : states) extreme.change(subject_.model.tree, state);
      const std::vector<ir::Body>& bodies = subject_.model.tree.bodies;
      if (extreme.large_angles && std::any_of(bodies.begin(), bodies.end(), [](const ir::Body& b) { return b.driven(); }))
        measured(extreme.name, {rounding_angles(code, true), rounding_angles(code, false)}, states, code, outputs());
      else measured(extreme.name, subject_.model, states, code);
    }
  }

  // What does not read where the base is does not change by a bit; what does is as exact there as elsewhere.
  void base_far_away(const Code& code) {
    const std::string name = "base at 1e12 m";
    std::vector<Output> moved, unmoved;
    for (const Output& output : outputs()) (cost_of(output.name).reads_base_position ? moved : unmoved).push_back(output);
    std::vector<State> home = states_, away = states_;
    for (State& state : home) state.q.head<3>().setZero();
    for (State& state : away) state.q.head<3>().setConstant(1e12);
    unchanged(name, home, away, code, unmoved);
    if (!moved.empty()) measured(name, subject_.model, away, code, moved);
  }

  // A quaternion that is not of unit length is taken as it is: results are finite, and where they do not read it unchanged.
  void quaternion(const std::string& name, double length, const Code& code) {
    State state = states_.front();
    const std::vector<Eigen::MatrixXd> unit = code.results(outputs(), state);
    state.q.segment<4>(3) *= length;
    const std::vector<Eigen::MatrixXd> results = code.results(outputs(), state);
    for (size_t o = 0; o < results.size(); ++o) {
      const double change = (results[o] - unit[o]).cwiseAbs().maxCoeff() / unit[o].cwiseAbs().maxCoeff();
      const bool reads = cost_of(outputs()[o].name).reads_base_pose;
      const Change bits = change_between(unit[o], results[o], code.scalar);
      const bool finite = results[o].allFinite();
      judge(name, outputs()[o].name, code, "change", std::isnan(change) && !reads ? 0 : change, "1",
            finite && (reads || bits.elements == 0) ? good : bad, [&] {
              return reads ? "not finite" : "does not read the quaternion, yet " + told(name, outputs()[o].name, code, bits);
            });
    }
  }

  // A number that is none comes out of every output that reads it, and of no other; what solves with M reports it.
  void poisoned(const std::string& name, double poison, bool of_position, const Code& code) {
    State state = states_.front();
    const std::vector<Eigen::MatrixXd> before = code.results(outputs(), state);
    Eigen::VectorXd& inputs = of_position ? state.q : state.v;
    const int last = static_cast<int>(inputs.size()) - 1;
    inputs[last] = poison;
    const std::vector<Eigen::MatrixXd> results = code.results(outputs(), state);
    for (size_t o = 0; o < results.size(); ++o) {
      const OperationCost& cost = cost_of(outputs()[o].name);
      const std::vector<int>& unread = of_position ? cost.positions_not_read : cost.velocities_not_read;
      const bool reads = std::find(unread.begin(), unread.end(), last) == unread.end();
      const bool reported = solves_with_mass(outputs()[o].name) && code.engine->status(outputs()[o]) >= 0;
      const double lost = static_cast<double>(reported ? results[o].size() : (!results[o].array().isFinite()).count());
      const Change bits = change_between(before[o], results[o], code.scalar);
      judge(name, outputs()[o].name, code, "elements_not_finite", lost, "elements",
            (reads ? lost > 0 : bits.elements == 0) ? good : bad, [&] {
              return reads ? "reads it, yet every element is finite and its status, if it has one, is good"
                           : "does not read it, yet " + told(name, outputs()[o].name, code, bits);
            });
    }
  }

  const std::vector<State>& states() const { return states_; }

 private:
  const std::vector<Output>& outputs() const { return subject_.outputs; }
  const OperationCost& cost_of(const std::string& name) const {
    return *std::find_if(costs_.begin(), costs_.end(), [&](const OperationCost& c) { return c.name == name; });
  }

  // Exact but for driven angles, which are as the code rounds them. Whether it fuses is the C++ compiler's choice.
  ModelAt rounding_angles(const Code& code, bool fused) const {
    return [this, scalar = code.scalar, fused](const State& state) {
      Model model = subject_.model;
      model.tree = with_rounded_angles(std::move(model.tree), state, scalar, fused);
      return std::make_shared<const Model>(std::move(model));
    };
  }

  bool solves_with_mass(const std::string& name) const { return solving_.contains(name); }

  // What solves with M errs with its condition: by 10 cond(M) 2⁻⁵³ at most.
  double limit(const Model& model, const Output& output, const State& state) const {
    if (!solves_with_mass(output.name)) return good_ulp;
    const Eigen::MatrixXd M = reference::evaluate(model.tree, model.scene, {{ir::Quantity::mass_matrix, ""}},
                                                  {state.q, state.v}, reference::Precision::float64)
                                  .front();
    const Eigen::VectorXd values = reference::eigenvalues(M);
    const double largest = values.tail<1>()[0], smallest = std::max(values[0], 0x1p-53 * largest);
    return std::max(good_ulp, 5 * largest / smallest);
  }

  // Of each state and the other, bit by bit.
  void unchanged(const std::string& name, const std::vector<State>& states, const std::vector<State>& others, const Code& code,
                 const std::vector<Output>& outputs) {
    std::vector<Change> changed(outputs.size());
    for (size_t s = 0; s < states.size(); ++s) {
      const std::vector<Eigen::MatrixXd> here = code.results(outputs, states[s]), there = code.results(outputs, others[s]);
      for (size_t o = 0; o < changed.size(); ++o) {
        const Change change = change_between(here[o], there[o], code.scalar);
        changed[o].elements += change.elements;
        changed[o].ulp = std::max(changed[o].ulp, change.ulp);
      }
    }
    for (size_t o = 0; o < changed.size(); ++o)
      judge(name, outputs[o].name, code, "elements_changed", changed[o].elements, "elements",
            changed[o].elements == 0 ? good : bad, [&] {
              more(name, outputs[o].name, code, "largest_change", changed[o].ulp, "ulp");
              return "does not read it, yet " + changed[o].told();
            });
  }

  // `violated` tells what was, and by how much, where the verdict is bad.
  void judge(const std::string& name, const std::string& output, const Code& code, const char* metric, double value,
             const char* unit, const char* verdict, const std::function<std::string()>& violated) {
    more(name, output, code, metric, value, unit);
    rows_.text("stability", name, output, code.name, "verdict", verdict);
    if (verdict == bad) rows_.text("stability", name, output, code.name, "violated", violated());
  }
  void more(const std::string& name, const std::string& output, const Code& code, const char* metric, double value,
            const char* unit) {
    rows_.number("stability", name, output, code.name, metric, value, unit);
  }
  // The change, which is in the table as well.
  std::string told(const std::string& name, const std::string& output, const Code& code, const Change& change) {
    more(name, output, code, "elements_changed", change.elements, "elements");
    more(name, output, code, "largest_change", change.ulp, "ulp");
    return change.told();
  }

  const Subject& subject_;
  Rows& rows_;
  const std::vector<State> states_;
  std::vector<OperationCost> costs_;
  std::set<std::string> solving_;  // outputs that solve with M, and say where it is singular
};

// A payload of many times the robot's mass in the centre of mass of the body that most joints carry.
Model with_payload(Model model) {
  ir::KinematicTree& tree = model.tree;
  double mass = tree.base.mass;
  for (const ir::Body& body : tree.bodies) mass += body.inertia.mass;
  std::vector<int> depth(tree.bodies.size(), 0);
  size_t tip = 0;
  for (size_t k = 0; k < tree.bodies.size(); ++k) {
    if (tree.bodies[k].parent >= 0) depth[k] = depth[static_cast<size_t>(tree.bodies[k].parent)] + 1;
    if (depth[k] >= depth[tip]) tip = k;
  }
  tree.bodies[tip].inertia.mass += heavy * mass;
  return model;
}

}  // namespace

std::vector<Order> stability_orders(const Subject& subject) {
  using enum ir::ScalarType;
  const auto order = [&](Model model, ir::ScalarType scalar) {
    model.scene.scalar = scalar;
    return Order{std::move(model), subject.outputs, subject.compiler};
  };
  std::vector<Order> orders = {order(subject.model, float64), order(subject.model, float32)};
  if (!subject.model.tree.bodies.empty()) {
    const Model loaded = with_payload(subject.model);
    orders.push_back(order(loaded, float64));
    if (!subject.quick) orders.push_back(order(loaded, float32));
  }
  return orders;
}

void add_stability(const Subject& subject, std::span<const std::unique_ptr<GeneratedEngine>> engines, Rows& rows) {
  using enum ir::ScalarType;
  const bool moves = !subject.model.tree.bodies.empty();
  const Model loaded = moves ? with_payload(subject.model) : subject.model;
  Stability stability(subject, rows);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (size_t i : {0, 1}) {
    const Code code{i == 0 ? "generated double" : "generated float", i == 0 ? float64 : float32, engines[i].get()};
    const CallTime time = engines[i]->time_per_call(stability.states());
    rows.number("rounding", random_case, "all", code.name, "time_median", time.median, "ns");
    rows.number("rounding", random_case, "all", code.name, "time_lower_quartile", time.lower_quartile, "ns");
    rows.number("rounding", random_case, "all", code.name, "time_upper_quartile", time.upper_quartile, "ns");
    if (i == 0) rows.text("rounding", random_case, "all", code.name, "chosen", "yes");
    stability.extremes(code);
    if (subject.model.tree.base_coordinates() > 0) {
      stability.base_far_away(code);
      stability.quaternion("quaternion of length 1.001", 1.001, code);
      stability.quaternion("quaternion of length 0", 0, code);
    }
    if (!moves) continue;
    if (i + 2 < engines.size())
      stability.measured("payload 1e4 times the robot", loaded, stability.states(),
                         {code.name, code.scalar, engines[i + 2].get()});
    stability.poisoned("last joint's position NaN", nan, true, code);
    stability.poisoned("last joint's position infinite", infinity, true, code);
    stability.poisoned("last joint's speed NaN", nan, false, code);
    stability.poisoned("last joint's speed infinite", infinity, false, code);
  }
}

}  // namespace dalembert::reporting
