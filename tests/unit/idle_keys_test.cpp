// A key of the scene is told to be idle where no result changes with it, and nowhere else: found from the equations
// (passes/reads.hpp), compared here with numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "commands/random_states.hpp"
#include "pipeline.hpp"
#include "reference/engine.hpp"

namespace dalembert {
namespace {

using Settings = std::vector<frontend::Setting>;

struct Robot {
  const char *name, *urdf, *joint;  // the joint that keys are given of
  Settings scene;
  bool (*has)(ir::Quantity);  // which quantities there are in the scene
};
bool is_of_motion(ir::Quantity quantity) { return !ir::is_of_constraints(quantity); }
bool is_any(ir::Quantity) { return true; }
const Robot robots[] = {
    {"arm", ROBOTS "/chain_7.urdf", "link_02_joint", {{"base", "fixed"}}, is_of_motion},
    {"floating", ROBOTS "/chain_7.urdf", "link_02_joint", {{"base", "floating"}}, is_of_motion},
    {"driven",
     ROBOTS "/chain_7.urdf",
     "link_05_joint",
     {{"base", "fixed"}, {"mimic", "{link_03_joint: {of: link_05_joint}}"}},
     is_of_motion},
    {"touching", ROBOTS "/chain_7.urdf", "link_02_joint", {{"base", "floating"}, {"contacts", "{link_07: point}"}}, is_any},
    {"embedded",
     MECHANISMS "/slider_crank.urdf",
     "slide",
     {{"base", "fixed"},
      {"loops", "{pin: {links: [slider, rod], at: [[0, 0, 0], [0.5, 0, 0]], type: pin, independent: [crank_turn]}}"}},
     ir::is_of_linkages},
};
const char* const keys[] = {"damping", "friction", "stiffness", "armature"};

Model model_with(const Robot& robot, const ir::QuantityRow& row, bool rates_zero, const char* key, Diagnostics& warnings) {
  Request request;
  request.robot = robot.urdf;
  request.settings = robot.scene;
  request.settings.push_back({"outputs", row.name});
  request.settings.push_back({"rates_zero", rates_zero ? "true" : "false"});
  if (key) request.settings.push_back({key, std::string(robot.joint) + "=0.3"});
  return read_model(request, warnings);
}

Eigen::MatrixXd value(const Model& model, const ir::QuantityRow& row) {
  const State state = random_states(model.tree, 1).front();
  const Eigen::VectorXd more = row.function == ir::Function::evaluate ? Eigen::VectorXd() : state.more;
  return reference::evaluate(model.tree, model.scene, {{row.quantity, ""}}, {state.q, state.v, more},
                             reference::Precision::float64)
      .front();
}

TEST(IdleKeys, AreThoseThatNoResultChangesWith) {
  for (const Robot& robot : robots) {
    int idle = 0, busy = 0;
    for (const ir::QuantityRow& row : ir::quantities())
      for (const bool rates_zero : {false, true}) {
        if (!robot.has(row.quantity) || (rates_zero && row.quantity == ir::Quantity::coriolis_matrix)) continue;
        Diagnostics none;
        const Eigen::MatrixXd without = value(model_with(robot, row, rates_zero, nullptr, none), row);
        if (without.isZero(0)) continue;  // at rest, whatever the equations read
        for (const char* key : keys) {
          Diagnostics said;
          const bool same = value(model_with(robot, row, rates_zero, key, said), row) == without;
          const bool told = std::any_of(said.begin(), said.end(), [&](const Diagnostic& warning) {
            return warning.element == std::string("scene key '") + key + "'";
          });
          // What is solved for with constraints is taken to depend on all that it is handed.
          const bool right = ir::is_of_constraints(row.quantity) ? same || !told : told == same;
          EXPECT_TRUE(right) << robot.name << ", " << row.name << " and " << key << (rates_zero ? ", at rest" : "")
                             << (told ? ": told to be idle" : ": nothing is told");
          ++(same ? idle : busy);
        }
      }
    EXPECT_GT(idle, 20) << robot.name;
    EXPECT_GT(busy, 20) << robot.name;
  }
}

}  // namespace
}  // namespace dalembert
