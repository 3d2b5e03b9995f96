// The generic engine and generated code against MuJoCo, on every test robot.
#include <dalembert/generic/dynamics.hpp>

#include "mujoco_oracle.hpp"
#include "oracle_tests.hpp"
#include "reference/generic_model.hpp"
#include "reference/instances.hpp"

namespace dalembert::oracle {
namespace {

class Mujoco : public ::testing::TestWithParam<Case> {};

MujocoOracle with_our_inertias(const Case& c, const ir::KinematicTree& tree) {
  MujocoOracle oracle(request_of(c, tree, testing::test_gravity), Inertias::overwritten);
  oracle.overwrite_inertias(tree);
  return oracle;
}

TEST_P(Mujoco, AgreesWithTheGenericEngine) {
  const ir::KinematicTree tree = tree_of(GetParam());
  MujocoOracle oracle = with_our_inertias(GetParam(), tree);
  expect_agreement(oracle, tree, generic_engine(tree, testing::test_gravity));
}

TEST_P(Mujoco, AgreesWithTheGenericEngineSolvedForEffortsAndAccelerations) {
  const ir::KinematicTree tree = tree_of(GetParam());
  MujocoOracle oracle = with_our_inertias(GetParam(), tree);
  expect_agreement(oracle, tree, generic_responder(tree, testing::test_gravity));
}

TEST_P(Mujoco, AgreesWithTheGenericEngineOnTheWholeRobot) {
  const ir::KinematicTree tree = tree_of(GetParam());
  MujocoOracle oracle = with_our_inertias(GetParam(), tree);
  for (int seed = 1; seed <= states_per_case; ++seed) {
    const testing::State state = testing::moderate_state(tree, static_cast<std::uint64_t>(seed));
    const WholeRobot ours = generic_whole_robot(tree, testing::test_gravity, state.q, state.v);
    for (const Error& error : compare(ours, oracle.whole_robot(state.q, state.v)))
      EXPECT_LE(error.value, tolerance) << error.quantity << ", state " << seed;
  }
}

TEST_P(Mujoco, AgreesWithTheGenericEngineOnSprings) {
  const ir::KinematicTree loose = tree_of(GetParam());
  ir::KinematicTree tree = loose;
  for (size_t k = 0; k < tree.bodies.size(); k += 2) tree.bodies[k].spring = {20.0 + static_cast<double>(k), 0.3};
  MujocoOracle oracle = with_our_inertias(GetParam(), tree);
  oracle.set_springs(tree);
  for (int seed = 1; seed <= states_per_case; ++seed) {
    const testing::State state = testing::moderate_state(tree, static_cast<std::uint64_t>(seed));
    const auto potential = [&](const WholeRobot& whole) { return whole.potential_energy; };
    const double right = potential(oracle.whole_robot(state.q, state.v));
    EXPECT_NEAR(potential(generic_whole_robot(tree, testing::test_gravity, state.q, state.v)), right,
                tolerance * std::abs(right));
    const auto bias = [&](const ir::KinematicTree& of) {
      return generic::bias<double>(to_generic<double>(of, testing::test_gravity), state.q, state.v);
    };
    const Eigen::VectorXd with = bias(tree), held = with - bias(loose), pushed = oracle.spring_forces(state.q);
    EXPECT_GT(pushed.norm(), 0);
    EXPECT_LE((held + pushed).norm(), tolerance * with.norm()) << "state " << seed;
  }
}

TEST_P(Mujoco, AgreesWithGeneratedCode) {
  const ir::KinematicTree tree = tree_of(GetParam());
  MujocoOracle oracle = with_our_inertias(GetParam(), tree);
  if (code_is_expected(GetParam())) expect_agreement(oracle, tree, generated_engine(GetParam()));
}

class MujocoInertias : public Mujoco {};

// Inertias too are MuJoCo's reading of the file, as exact as its principal axes are.
TEST_P(MujocoInertias, AreReadTheSame) {
  const ir::KinematicTree tree = tree_of(GetParam());
  MujocoOracle oracle(request_of(GetParam(), tree, testing::test_gravity), Inertias::as_read);
  expect_agreement(oracle, tree, generic_engine(tree, testing::test_gravity), 1e-5);
}

// MuJoCo refuses bodies without mass.
std::vector<Case> cases_with_mass() {
  std::vector<Case> cases = all_cases();
  std::erase_if(cases, [](const Case& c) { return std::string(c.robot.name) == "massless_intermediate"; });
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Robots, Mujoco, ::testing::ValuesIn(all_cases()), case_name);
INSTANTIATE_TEST_SUITE_P(Robots, MujocoInertias, ::testing::ValuesIn(cases_with_mass()), case_name);

TEST(MujocoOracle, NoticesMutations) { expect_mutations_noticed(with_our_inertias); }

TEST(MujocoOracle, NoticesAHeavierLinkInTheWholeRobot) {
  for (const Base base : {Base::floating, Base::fixed}) {
    const Case c = mutated_case(base);
    ir::KinematicTree tree = tree_of(c);
    MujocoOracle oracle = with_our_inertias(c, tree);
    const testing::State state = testing::moderate_state(tree, 1);
    const WholeRobot right = oracle.whole_robot(state.q, state.v);
    tree.bodies.back().inertia.mass *= 1 + 1e-6;
    tree.bodies.back().placement.translation()[0] += 1e-6;
    for (const Error& error : compare(generic_whole_robot(tree, testing::test_gravity, state.q, state.v), right))
      EXPECT_GT(error.value, tolerance) << error.quantity;
  }
}

TEST(MujocoOracle, NamesTheJointItDoesNotKnow) {
  const Case c = mutated_case(Base::fixed);
  Request request = request_of(c, tree_of(c), testing::test_gravity);
  request.joints.back() = "no_such_joint";
  try {
    MujocoOracle oracle(request, Inertias::as_read);
    FAIL() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("no_such_joint"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace dalembert::oracle
