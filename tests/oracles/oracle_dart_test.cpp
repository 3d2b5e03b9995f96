// The generic engine and generated code against DART, which reads inertias and fixed joints itself, on every test robot.
#include "dart_oracle.hpp"
#include "oracle_tests.hpp"
#include "passes/build_tree.hpp"
#include "reference/generic_model.hpp"
#include "reference/instances.hpp"

namespace dalembert::oracle {
namespace {

class Dart : public ::testing::TestWithParam<Case> {};

DartOracle dart(const Case& c, const ir::KinematicTree& tree) { return DartOracle(request_of(c, tree, testing::test_gravity)); }

TEST_P(Dart, AgreesWithTheGenericEngine) {
  const ir::KinematicTree tree = tree_of(GetParam());
  DartOracle oracle = dart(GetParam(), tree);
  expect_agreement(oracle, tree, generic_engine(tree, testing::test_gravity));
}

TEST_P(Dart, AgreesWithTheGenericEngineSolvedForEffortsAndAccelerations) {
  const ir::KinematicTree tree = tree_of(GetParam());
  DartOracle oracle = dart(GetParam(), tree);
  expect_agreement(oracle, tree, generic_responder(tree, testing::test_gravity));
}

TEST_P(Dart, AgreesWithGeneratedCode) {
  const ir::KinematicTree tree = tree_of(GetParam());
  DartOracle oracle = dart(GetParam(), tree);
  if (code_is_expected(GetParam())) expect_agreement(oracle, tree, generated_engine(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Robots, Dart, ::testing::ValuesIn(all_cases()), case_name);

// Kinds of joints that URDF has no word for, as DART has them, in trees where they stand below and above others.
class DartKinds : public ::testing::TestWithParam<std::tuple<std::string, bool>> {};

TEST_P(DartKinds, AgreeWithTheGenericEngine) {
  const KindsRobot robot = joint_kinds_robot(std::get<0>(GetParam()));
  ir::Scene scene;
  scene.base = std::get<1>(GetParam()) ? ir::Base::floating : ir::Base::fixed;
  scene.gravity = testing::test_gravity;
  scene.joints = robot.joints;
  Diagnostics warnings;
  const ir::KinematicTree tree = passes::build_tree(robot.robot, scene, warnings);
  const generic::Model<double> model = to_generic<double>(tree, scene.gravity);
  std::vector<KindsCoordinate> coordinates;
  std::vector<int> positions = tree.positions();
  for (const ir::Body& body : tree.bodies) coordinates.push_back({body.of.empty() ? body.joint : body.of, body.part});
  for (int& at : positions) at += tree.base_positions();
  for (int seed = 1; seed <= states_per_case; ++seed) {
    const testing::State state = testing::moderate_state(tree, static_cast<std::uint64_t>(seed));
    const Eigen::VectorXd tau = testing::moderate_state(tree, static_cast<std::uint64_t>(seed + 100)).v;
    const KindsAnswer theirs =
        dart_answer(robot, coordinates, positions, tree.base_coordinates() > 0, scene.gravity, state.q, state.v, tau);
    const auto error = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
      return (a - b).cwiseAbs().maxCoeff<Eigen::PropagateNaN>() / b.cwiseAbs().maxCoeff();
    };
    EXPECT_LE(error(generic::mass_matrix<double>(model, state.q), theirs.mass_matrix), tolerance) << seed;
    EXPECT_LE(error(generic::bias<double>(model, state.q, state.v), theirs.bias), tolerance) << seed;
    EXPECT_LE(error(generic::forward_dynamics<double>(model, state.q, state.v, tau).value, theirs.forward_dynamics), tolerance)
        << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, DartKinds, ::testing::Combine(::testing::ValuesIn(joint_kind_robots()), ::testing::Bool()),
                         [](const auto& info) {
                           return std::get<0>(info.param) + (std::get<1>(info.param) ? "_floating" : "_fixed");
                         });

TEST(DartOracle, NoticesMutations) { expect_mutations_noticed(dart); }

}  // namespace
}  // namespace dalembert::oracle
