#include "scene_examples.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "arm_gravity/c_api.h"
#include "arm_gravity/dynamics.hpp"
#include "arm_mass_matrix/c_api.h"
#include "arm_mass_matrix/dynamics.hpp"
#include "commands/generic_engine.hpp"
#include "full_humanoid/c_api.h"
#include "full_humanoid/dynamics.hpp"
#include "full_mass_coriolis/c_api.h"
#include "full_mass_coriolis/dynamics.hpp"
#include "legs_only/c_api.h"
#include "legs_only/dynamics.hpp"
#include "planar_biped/c_api.h"
#include "planar_biped/dynamics.hpp"

namespace dalembert::scenes {
namespace {

Example load(const std::string& name, const std::string& meaning, const std::string& urdf, const std::string& scene,
             const std::vector<frontend::Setting>& settings = {}) {
  Request request;
  request.robot = urdf;
  request.scene_file = std::string(SCENES "/") + scene + ".yaml";
  request.settings = settings;
  request.name = name;
  Diagnostics warnings;
  return {name, meaning, read_model(request, warnings), ARCHIVES "/lib" + name + ".a", 0, {}, {}, {}};
}

// Binds the C functions of the code called `name`.
#define BIND(example, name)                                                                                            \
  example.workspace_bytes = sizeof(::name::Workspace);                                                                 \
  example.workspace = [] {                                                                                             \
    return std::shared_ptr<void>(name##_create(), [](void* w) { name##_destroy(static_cast<name##_workspace*>(w)); }); \
  };                                                                                                                   \
  example.evaluate = [](const double* q, const double* v, void* w) { name##_evaluate(q, v, static_cast<name##_workspace*>(w)); }
#define RESULT(example, name, quantity)                                \
  example.results.emplace_back(output_named(example.model, #quantity), \
                               [](const void* w) { return name##_##quantity(static_cast<const name##_workspace*>(w)); })

std::vector<Example> make() {
  std::vector<Example> list;
  {
    Example& e = list.emplace_back(load("arm_gravity", "gravity compensation of an arm, with a payload", MAHRU, "arm_gravity"));
    BIND(e, arm_gravity);
    RESULT(e, arm_gravity, gravity);
  }
  {
    Example& e = list.emplace_back(load("arm_mass_matrix", "M of an arm on a fixed trunk", MAHRU, "arm_mass_matrix"));
    BIND(e, arm_mass_matrix);
    RESULT(e, arm_mass_matrix, mass_matrix);
  }
  {
    Example& e =
        list.emplace_back(load("planar_biped", "M, C, g of a planar biped", SCENES "/planar_biped.urdf", "planar_biped"));
    BIND(e, planar_biped);
    RESULT(e, planar_biped, mass_matrix);
    RESULT(e, planar_biped, coriolis_matrix);
    RESULT(e, planar_biped, gravity);
  }
  {
    Example& e = list.emplace_back(load("legs_only", "M and C of the legs, waist and arms locked", MAHRU, "legs_only"));
    BIND(e, legs_only);
    RESULT(e, legs_only, mass_matrix);
    RESULT(e, legs_only, coriolis_matrix);
  }
  {
    Example& e = list.emplace_back(load("full_mass_coriolis", "M and C of the full humanoid, to compare legs_only with", MAHRU,
                                        "full_humanoid", {{"outputs", "mass_matrix,coriolis_matrix"}}));
    BIND(e, full_mass_coriolis);
    RESULT(e, full_mass_coriolis, mass_matrix);
    RESULT(e, full_mass_coriolis, coriolis_matrix);
  }
  {
    Example& e =
        list.emplace_back(load("full_humanoid", "M, C, g, C v + g and W of the full humanoid", MAHRU, "full_humanoid"));
    BIND(e, full_humanoid);
    RESULT(e, full_humanoid, mass_matrix);
    RESULT(e, full_humanoid, coriolis_matrix);
    RESULT(e, full_humanoid, gravity);
    RESULT(e, full_humanoid, bias);
    RESULT(e, full_humanoid, wrench_influence);
  }
  return list;
}

}  // namespace

const std::vector<Example>& examples() {
  static const std::vector<Example> list = make();
  return list;
}

const Example& example(const std::string& name) {
  for (const Example& e : examples())
    if (e.name == name) return e;
  throw std::invalid_argument("no example " + name);
}

double error_of(const Example& example, const std::vector<State>& states) {
  const std::shared_ptr<void> workspace = example.workspace();
  double error = 0;
  for (const auto& [output, result] : example.results) {
    double difference = 0, largest = 0;
    for (const State& state : states) {
      example.evaluate(state.q.data(), state.v.data(), workspace.get());
      const Eigen::Map<const Eigen::MatrixXd> value(result(workspace.get()), output.rows, output.columns);
      const Eigen::MatrixXd expected = evaluate_generic(example.model, output, state);
      difference = std::max(difference, (value - expected).cwiseAbs().maxCoeff<Eigen::PropagateNaN>());
      if (value.hasNaN()) return std::numeric_limits<double>::infinity();
      largest = std::max(largest, expected.cwiseAbs().maxCoeff());
    }
    if (largest == 0) return std::numeric_limits<double>::infinity();  // nothing was compared
    error = std::max(error, difference / largest);
  }
  return error;
}

}  // namespace dalembert::scenes
