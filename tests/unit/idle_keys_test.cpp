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

struct Key {
  std::string key, text;
};
const Key keys[] = {{"damping", "link_02_joint=0.3"},
                    {"friction", "link_02_joint=0.3"},
                    {"stiffness", "link_02_joint=3"},
                    {"armature", "link_02_joint=0.2"}};

Model model_with(const std::string& base, const std::string& output, bool rates_zero, const Key* key, Diagnostics& warnings) {
  Request request;
  request.robot = ROBOT;
  request.settings = {{"base", base}, {"outputs", output}, {"rates_zero", rates_zero ? "true" : "false"}};
  if (key) request.settings.push_back({key->key, key->text});
  return read_model(request, warnings);
}

Eigen::MatrixXd value(const Model& model, const ir::QuantityRow& row) {
  State state = random_states(model.tree, 1).front();
  const Eigen::VectorXd more = row.function == ir::Function::evaluate ? Eigen::VectorXd() : state.more;
  return reference::evaluate(model.tree, model.scene, {{row.quantity, ""}}, {state.q, state.v, more},
                             reference::Precision::float64)
      .front();
}

TEST(IdleKeys, AreThoseThatNoResultChangesWith) {
  int idle = 0, busy = 0;
  for (const ir::QuantityRow& row : ir::quantities()) {
    if (ir::is_of_constraints(row.quantity)) continue;
    for (const std::string base : {"fixed", "floating"})
      for (const bool rates_zero : {false, true}) {
        if (rates_zero && row.quantity == ir::Quantity::coriolis_matrix) continue;  // refused
        Diagnostics none;
        const Eigen::MatrixXd without = value(model_with(base, row.name, rates_zero, nullptr, none), row);
        if (without.isZero(0)) continue;  // at rest, whatever the equations read
        for (const Key& key : keys) {
          Diagnostics said;
          const bool same = value(model_with(base, row.name, rates_zero, &key, said), row) == without;
          const bool told = std::any_of(said.begin(), said.end(), [&](const Diagnostic& warning) {
            return warning.element == "scene key '" + key.key + "'";
          });
          EXPECT_EQ(told, same) << row.name << " and " << key.key << ", " << base << (rates_zero ? ", at rest" : "");
          ++(same ? idle : busy);
        }
      }
  }
  EXPECT_GT(idle, 50);
  EXPECT_GT(busy, 50);
}

}  // namespace
}  // namespace dalembert
