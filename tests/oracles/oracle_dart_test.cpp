// The generic engine and generated code against DART, which reads inertias and fixed joints itself, on every test robot.
#include "dart_oracle.hpp"
#include "oracle_tests.hpp"

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
  expect_agreement(oracle, tree, generated_engine(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Robots, Dart, ::testing::ValuesIn(all_cases()), case_name);

TEST(DartOracle, NoticesMutations) { expect_mutations_noticed(dart); }

}  // namespace
}  // namespace dalembert::oracle
