// The identities of identities.hpp on every robot, with both bases.
#include "identities.hpp"

#include <gtest/gtest.h>

#include "load_robot.hpp"
#include "scale.hpp"
#include "states.hpp"

namespace dalembert::testing {
namespace {

// Differences leave about 1e-38 where they are nested; anything above 1e-25 is a wrong formula.
constexpr double tolerance = 1e-25;

using RobotAndBase = std::tuple<TestRobot, bool>;
class Identities : public ::testing::TestWithParam<RobotAndBase> {};

TEST_P(Identities, Hold) {
  const auto [robot, floating] = GetParam();
  const ir::KinematicTree tree = load_robot(robot, floating);
  const State state = moderate_state(tree, 1);
  const Case one{exact_model(tree, test_gravity), exact_position(tree, state.q), state.v.cast<Multi>()};
  const Dynamics result = generic::evaluate<Multi>(one.model, one.q, one.v);
  ASSERT_EQ(result.mass_matrix.rows(), tree.nv());
  for (const Identity& identity : identities) {
    const double error = identity.error(one, result);
    EXPECT_LE(error, identity.error == sparsity_error ? 0 : tolerance) << identity.name;
  }
}

// C is linear in v, and vanishes with it.
TEST_P(Identities, CoriolisMatrixIsLinearInVelocity) {
  const auto [robot, floating] = GetParam();
  const ir::KinematicTree tree = load_robot(robot, floating);
  const State a = moderate_state(tree, 2), b = moderate_state(tree, 3);
  const Model model = exact_model(tree, test_gravity);
  const Vector q = exact_position(tree, a.q), u = a.v.cast<Multi>(), v = b.v.cast<Multi>();
  const auto C = [&](const Vector& velocity) { return generic::coriolis_matrix<Multi>(model, q, velocity); };
  const Scale<Multi> scale(generic::evaluate<Multi>(model, q, u), u);
  EXPECT_LE(relative_error(C(u + 3 * v), Matrix(C(u) + 3 * C(v)), scale.coriolis_matrix), 1e-80);
  EXPECT_EQ(C(0 * u).cwiseAbs().maxCoeff(), 0);
}

INSTANTIATE_TEST_SUITE_P(Robots, Identities,
                         ::testing::Combine(::testing::ValuesIn(test_robots_and_kinds()), ::testing::Bool()),
                         [](const auto& info) {
                           return std::string(std::get<0>(info.param).name) +
                                  (std::get<1>(info.param) ? "_floating" : "_fixed");
                         });

}  // namespace
}  // namespace dalembert::testing
