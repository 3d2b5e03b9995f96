// Rounding errors of the generic engine: float, double and long double against 100 digits, on moderate and extreme states.
#include <gtest/gtest.h>

#include "load_robot.hpp"
#include "multiprecision.hpp"
#include "reference/generic_model.hpp"
#include "reference/instances.hpp"
#include "scale.hpp"
#include "states.hpp"

namespace dalembert::testing {
namespace {

using RobotAndBase = std::tuple<TestRobot, bool>;
class Precision : public ::testing::TestWithParam<RobotAndBase> {};

// Largest relative error of any quantity. The reference takes the very numbers that S holds, so that only the computation's
// rounding is seen and not that of its input.
template <class S>
double largest_error(const ir::KinematicTree& tree, const State& state) {
  const generic::Model<S> model = to_generic<S>(tree, test_gravity);
  generic::Model<Multi> exact_model = to_generic<Multi>(tree, test_gravity);
  const auto as_held = [](auto& exact, const auto& held) { exact = held.template cast<Multi>(); };
  const auto hold = [&](Inertia<Multi>& exact, const Inertia<S>& held) {
    exact.mass = Multi(held.mass);
    as_held(exact.com, held.com);
    as_held(exact.inertia, held.inertia);
  };
  hold(exact_model.base, model.base);
  as_held(exact_model.gravity, model.gravity);
  for (size_t k = 0; k < model.bodies.size(); ++k) {
    generic::Body<Multi>& exact = exact_model.bodies[k];
    const generic::Body<S>& held = model.bodies[k];
    as_held(exact.axis, held.axis);
    as_held(exact.rotation, held.rotation);
    as_held(exact.translation, held.translation);
    hold(exact.inertia, held.inertia);
  }
  const VectorX<S> q = state.q.cast<S>(), v = state.v.cast<S>();
  const auto rounded = generic::evaluate<S>(model, q, v);
  const auto exact = generic::evaluate<Multi>(exact_model, q.template cast<Multi>(), v.template cast<Multi>());
  const Scale<Multi> scale(exact, v.template cast<Multi>());
  const auto error = [](const auto& a, const auto& b, const Multi& s) {
    return relative_error(a.template cast<Multi>(), b, s);
  };
  return std::max({error(rounded.mass_matrix, exact.mass_matrix, scale.mass_matrix),
                   error(rounded.coriolis_matrix, exact.coriolis_matrix, scale.coriolis_matrix),
                   error(rounded.gravity, exact.gravity, scale.gravity), error(rounded.bias, exact.bias, scale.bias),
                   error(rounded.wrench_influence, exact.wrench_influence, scale.wrench_influence)});
}

TEST_P(Precision, IsThatOfTheScalar) {
  const auto [robot, floating] = GetParam();
  const ir::KinematicTree tree = load_robot(robot, floating);
  const State state = moderate_state(tree, 4);
  const double in_float = largest_error<float>(tree, state), in_double = largest_error<double>(tree, state),
               in_long_double = largest_error<long double>(tree, state);
  EXPECT_LE(in_float, 1e-4);
  EXPECT_LE(in_double, 1e-13);
  EXPECT_LE(in_long_double, 1e-16);
  RecordProperty("float", std::to_string(in_float * 1e7) + "e-7");
  RecordProperty("double", std::to_string(in_double * 1e16) + "e-16");
  RecordProperty("long_double", std::to_string(in_long_double * 1e19) + "e-19");
}

TEST_P(Precision, HoldsInExtremeStates) {
  const auto [robot, floating] = GetParam();
  const ir::KinematicTree tree = load_robot(robot, floating);
  for (const State& state : extreme_states(tree)) EXPECT_LE(largest_error<double>(tree, state), 1e-12) << state.name;
}

INSTANTIATE_TEST_SUITE_P(Robots, Precision, ::testing::Combine(::testing::ValuesIn(test_robots), ::testing::Bool()),
                         [](const auto& info) {
                           return std::string(std::get<0>(info.param).name) +
                                  (std::get<1>(info.param) ? "_floating" : "_fixed");
                         });

}  // namespace
}  // namespace dalembert::testing
