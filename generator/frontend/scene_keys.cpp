#include "frontend/scene_keys.hpp"

#include <fmt/format.h>

#include "frontend/nearest.hpp"
#include "ir/plan_words.hpp"

namespace dalembert::frontend {

const std::vector<SceneKeys::Key>& SceneKeys::keys() {
  static const std::vector<Key> keys = {{"base", &SceneKeys::base},
                                        {"gravity", &SceneKeys::gravity},
                                        {"outputs", &SceneKeys::outputs},
                                        {"functions", &SceneKeys::functions},
                                        {"coriolis", &SceneKeys::coriolis},
                                        {"forward_dynamics", &SceneKeys::forward_dynamics},
                                        {"locked", &SceneKeys::locked},
                                        {"cut", &SceneKeys::cut},
                                        {"joints", &SceneKeys::joints},
                                        {"mimic", &SceneKeys::mimic},
                                        {"jacobians", &SceneKeys::jacobians},
                                        {"frames", &SceneKeys::frames},
                                        {"payloads", &SceneKeys::payloads},
                                        {"wrenches", &SceneKeys::wrenches},
                                        {"contacts", &SceneKeys::contacts},
                                        {"loops", &SceneKeys::loops},
                                        {"passive", &SceneKeys::passive},
                                        {"armature", &SceneKeys::armature},
                                        {"damping", &SceneKeys::damping},
                                        {"friction", &SceneKeys::friction},
                                        {"stiffness", &SceneKeys::stiffness},
                                        {"elastic", &SceneKeys::elastic},
                                        {"massless", &SceneKeys::massless},
                                        {"inertia", &SceneKeys::inertia},
                                        {"rates_zero", &SceneKeys::rates_zero},
                                        {"scalar", &SceneKeys::scalar},
                                        {"parallel", &SceneKeys::parallel},
                                        {"plan", &SceneKeys::plan},
                                        {"batch", &SceneKeys::batch},
                                        {"rollouts", &SceneKeys::rollouts}};
  return keys;
}

void SceneKeys::read(const std::string& key, const YamlNode& name, const YamlNode& value) {
  key_ = key;
  entry_.clear();
  document_.largest.erase(key);
  for (const Key& known : keys()) {
    if (key != known.name) continue;
    document_.given.insert(key);
    document_.places[key] = place(name);
    (this->*known.read)(value);
    return;
  }
  refuse(name, fmt::format("the key '{}' is unknown", key), suggestion(key, scene_keys()));
}

void SceneKeys::base(const YamlNode& node) {
  scene_.base = choice<ir::Base>(node, {{"fixed", ir::Base::fixed}, {"floating", ir::Base::floating}});
}

void SceneKeys::gravity(const YamlNode& node) {
  const std::string remedy = "write [0, 0, -9.81], none, run_time, or {run_time: [0, 0, -9.81]}";
  scene_.gravity = ir::Scene{}.gravity;
  scene_.gravity_kind = ir::GravityKind::constant;
  if (node.is_sequence()) {
    scene_.gravity = vector(node, remedy);
  } else if (node.is_scalar() && node.scalar == "none") {
    scene_.gravity_kind = ir::GravityKind::none;
    scene_.gravity.setZero();
  } else if (node.is_scalar() && node.scalar == "run_time") {
    scene_.gravity_kind = ir::GravityKind::run_time;
  } else if (node.is_map() && node.entries.size() == 1 && node.entries[0].key.is_scalar() &&
             node.entries[0].key.scalar == "run_time") {
    scene_.gravity_kind = ir::GravityKind::run_time;
    scene_.gravity = vector(node.entries[0].value, remedy);
  } else {
    refuse(node, "the value is no gravity", remedy);
  }
}

void SceneKeys::coriolis(const YamlNode& node) {
  scene_.coriolis =
      choice<ir::Coriolis>(node, {{"balance", ir::Coriolis::balance}, {"christoffel", ir::Coriolis::christoffel}});
}

void SceneKeys::forward_dynamics(const YamlNode& node) {
  scene_.forward_dynamics = choice<ir::Solver>(
      node, {{"articulated_bodies", ir::Solver::articulated_bodies}, {"factorization", ir::Solver::factorization}});
}

void SceneKeys::massless(const YamlNode& node) { scene_.lock_massless = choice<bool>(node, {{"keep", false}, {"lock", true}}); }

void SceneKeys::inertia(const YamlNode& node) {
  scene_.inertia = choice<ir::InertiaPolicy>(
      node,
      {{"refuse", ir::InertiaPolicy::refuse}, {"accept", ir::InertiaPolicy::accept}, {"repair", ir::InertiaPolicy::repair}});
}

void SceneKeys::rates_zero(const YamlNode& node) { scene_.rates_zero = choice<bool>(node, {{"true", true}, {"false", false}}); }

void SceneKeys::scalar(const YamlNode& node) {
  scene_.scalar = choice<ir::ScalarType>(node, {{"double", ir::ScalarType::float64}, {"float", ir::ScalarType::float32}});
}

void SceneKeys::parallel(const YamlNode& node) {
  scene_.parallel = choice<ir::Parallel>(
      node, {{"serial", ir::Parallel::serial}, {"tasks", ir::Parallel::tasks}, {"auto", ir::Parallel::automatic}});
}

void SceneKeys::plan(const YamlNode& node) {
  scene_.plan.clear();
  forget_entries();
  const std::string remedy = "write plan: {evaluate: {form: straight}}, or let 'dalembert generate --plan measure' find it";
  if (node.is_scalar() && node.scalar == "measure")
    refuse(node, "'measure' is for the command line of generate and info", "write what was measured: " + remedy.substr(6));
  if (!node.is_map()) refuse(node, "the value is no map from functions to how they are computed", remedy);
  for (const auto& entry : node.entries) {
    const std::string function = entry_name(entry.key);
    if (!entry.value.is_map()) refuse(entry.value, fmt::format("how '{}' is computed is no map", function), remedy);
    ir::FunctionPlan& how = scene_.plan[function];
    for (const auto& part : entry.value.entries) {
      const std::string name = entry_name(part.key, function);
      if (name == "form") how.form = word(part.value, ir::form_words());
      else if (name == "solver") how.solver = word(part.value, ir::solver_words());
      else if (name == "order") how.order = word(part.value, ir::order_words());
      else
        refuse(part.key, fmt::format("'{}' is no part of a function's plan", name),
               suggestion(name, {"form", "solver", "order"}));
    }
    if (how.form == ir::Form::rolled && how.order)
      refuse(entry.value, fmt::format("'{}' is rolled, and loops have no order of statements", function),
             "leave the order out, or write form: straight");
  }
}

void SceneKeys::batch(const YamlNode& node) { scene_.batch = choice<bool>(node, {{"true", true}, {"false", false}}); }

void SceneKeys::rollouts(const YamlNode& node) {
  scene_.linearly_implicit = scene_.impacts = false;
  for (const YamlNode& item : list(node, "a list of what rollouts shall know, such as [linearly_implicit]")) {
    if (item.scalar == "semi_implicit_euler" || item.scalar == "rk4")
      refuse(item, fmt::format("every rollout has '{}'", item.scalar), "leave it out");
    if (item.scalar == "linearly_implicit") scene_.linearly_implicit = true;
    else if (item.scalar == "impacts") scene_.impacts = true;
    else
      refuse(item, fmt::format("rollouts know no '{}'", item.scalar),
             suggestion(item.scalar, {"linearly_implicit", "impacts"}));
  }
}

}  // namespace dalembert::frontend
