// What the emitted self-test expects of whom, and that code passes it which is right but ill-conditioned, driven or loaded.
#include "reference/self_test.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "commands/generated_engine.hpp"
#include "pipeline.hpp"
#include "read_robot.hpp"
#include "reference/engine.hpp"

namespace dalembert {
namespace {

using Kind = ir::Expectation::Kind;

// Empty when the emitted self-test passes.
std::string run(const Model& model) {
  const CompilerOptions compiler{.compiler = "", .flags = "-std=c++17 -O0 " PRECOMPILED_EIGEN};
  return GeneratedEngine(model, outputs_of(model), compiler, Besides::self_test).self_test();
}

TEST(SelfTest, InputsAreDistinctAndNoneIsNearZero) {
  for (const char* scalar : {"double", "float"}) {
    const Model model = read_robot("gantry_arms", {{"base", "floating"}, {"gravity", "run_time"}, {"scalar", scalar}});
    const ir::SelfTest test = reference::self_test(model.tree, model.scene);
    ASSERT_EQ(test.states.size(), 3u);
    std::set<double> seen;
    for (const ir::SelfTest::State& state : test.states) {
      for (const Eigen::VectorXd& inputs : {state.q, state.v})
        for (const double x : inputs) {
          EXPECT_GE(std::abs(x), 0.1);
          EXPECT_TRUE(seen.insert(x).second) << x;
          EXPECT_TRUE(scalar == std::string("double") || x == static_cast<float>(x)) << x;
        }
      EXPECT_NEAR((state.q.segment<4>(3).norm()), 1, 1e-7);
    }
    EXPECT_GT(test.gravity.cwiseAbs().minCoeff(), 1);
  }
}

TEST(SelfTest, SmallMatricesAreComparedWholeAndLargeOnesInColumnsAndByRow) {
  for (const char* robot : {"chain_7", "tree_5x20"}) {
    const Model model = read_robot(robot, {{"base", "fixed"}, {"outputs", "mass_matrix,coriolis_matrix,gravity"}});
    const ir::SelfTest test = reference::self_test(model.tree, model.scene);
    const bool small = model.tree.nv() == 7;
    EXPECT_EQ(test.precision, small ? "50 digits" : "long double");
    EXPECT_TRUE(test.left_out.empty());
    int elements = 0, products = 0;
    for (const ir::Expectation& e : test.expectations) {
      const size_t nv = static_cast<size_t>(model.tree.nv());
      if (e.kind == Kind::products) {
        ++products;
        EXPECT_EQ(e.values.size(), nv);
      } else {
        ++elements;
        EXPECT_TRUE(e.complete || !small);
        EXPECT_TRUE(!small || e.array != 0 || e.values.size() == nv * (nv + 1) / 2) << e.values.size();
      }
      EXPECT_TRUE(std::any_of(e.values.begin(), e.values.end(), [](double x) { return x != 0; }));
      EXPECT_GE(e.tolerance, 512 * 0x1p-52);
      EXPECT_LE(e.tolerance, 1e-11);
    }
    EXPECT_EQ(elements, 2 + 3);
    EXPECT_EQ(products, 2 * 3);
  }
}

// Long double stands in for 50 digits where those take too long: it is near enough.
TEST(SelfTest, BothPrecisionsAgree) {
  const Model model = read_robot("chain_50", {{"base", "fixed"}});
  const ir::SelfTest test = reference::self_test(model.tree, model.scene);
  const ir::SelfTest::State& state = test.states[2];
  for (const ir::Quantity quantity : model.scene.outputs) {
    const auto by = [&](reference::Precision precision) {
      return reference::evaluate(model.tree, model.scene, {{quantity, ""}}, {state.q, state.v, state.input}, precision).front();
    };
    const Eigen::MatrixXd exact = by(reference::Precision::digits_50);
    EXPECT_LE((by(reference::Precision::extended) - exact).cwiseAbs().maxCoeff(), 0x1p-52 * exact.cwiseAbs().maxCoeff());
  }
}

// A product of conditions is larger than what can be lost: what is wrong by a tenth is found all the same.
TEST(SelfTest, FindsWhatIsWrongByATenthWhereContactsHold) {
  const std::map<std::string, std::string> contacts{
      {"quadruped",
       "{front_left_3_shank: point, front_right_3_shank: point, hind_left_3_shank: point, hind_right_3_shank: point}"},
      {"mahru", "{left_foot: weld, right_foot: weld}"}};
  for (const auto& [robot, held] : contacts)
    for (const char* scalar : {"double", "float"}) {
      const std::string derivatives = scalar == std::string("double") ? ",constrained_forward_dynamics_dq" : "";
      const Model model =
          read_robot(robot, {{"base", "floating"},
                             {"scalar", scalar},
                             {"contacts", held},
                             {"outputs", "constrained_forward_dynamics,constraint_forces,impact" + derivatives}});
      const ir::SelfTest test = reference::self_test(model.tree, model.scene);
      for (const ir::Expectation& e : test.expectations)
        EXPECT_LT(e.tolerance, 0.1) << robot << ", " << scalar << ", output " << e.array << ", state " << e.state;
    }
}

// But right code does not fail: of what rows say that is next to nothing beside the most, derivatives are not those of the
// steps that solve for forces. Here a point next to the axis of the only joint between it and what is held.
TEST(SelfTest, AllowsDerivativesMoreWhereRowsNearlySayTheSame) {
  const Model model =
      read_robot("two_branches_at_base",
                 {{"base", "floating"},
                  {"rates_zero", "true"},
                  {"contacts", "{a: {link: base, type: weld}, b: {link: a_01, type: point, at: [1e-5, 1e-5, 1e-5]}}"},
                  {"outputs", "constrained_forward_dynamics,constrained_forward_dynamics_dq"}});
  for (const ir::Expectation& e : reference::self_test(model.tree, model.scene).expectations)
    EXPECT_EQ(e.tolerance > 1, e.array == 1) << "output " << e.array << ", state " << e.state << ": " << e.tolerance;
}

// What the scalar cannot hold is not compared: right code overflows too.
TEST(SelfTest, LeavesOutWhatOverflows) {
  Model model =
      read_robot("pendulum", {{"base", "fixed"}, {"scalar", "float"}, {"outputs", "mass_matrix,gravity,coriolis_matrix"}});
  model.tree.bodies[0].inertia = {1e37, {10, 20, 30}, Eigen::Matrix3d::Identity()};
  const ir::SelfTest test = reference::self_test(model.tree, model.scene);
  EXPECT_EQ(test.left_out, (std::vector<int>{0, 1}));
  EXPECT_FALSE(test.expectations.empty());
  for (const ir::Expectation& e : test.expectations) EXPECT_EQ(e.array, 2);
}

// The motor and the spring of an elastic joint turn about one axis: what they do to each other's motion cancels, but for the
// last places of terms that do not know of it.
const Settings vanishing{{"base", "fixed"},
                         {"elastic", "{link_1_joint: {k: 100, inertia: 0.1}}"},
                         {"outputs", "mass_matrix"},
                         {"frames", "{link_1: [acceleration_bias_mixed], link_3: [acceleration_bias_mixed]}"}};

TEST(SelfTest, WhatVanishesMayErrByTheLastPlacesOfWhatCancels) {
  const Model model = read_robot("skew_axes", vanishing);
  const ir::SelfTest test = reference::self_test(model.tree, model.scene);
  const double epsilon = 0x1p-52;
  int vanished = 0;
  for (const ir::Expectation& e : test.expectations) {
    const bool of_first_link = e.array == 1;
    EXPECT_EQ(std::all_of(e.values.begin(), e.values.end(), [](double x) { return x == 0; }), of_first_link);
    if (of_first_link) EXPECT_GE(e.tolerance, 4096 * epsilon);
    else EXPECT_LT(e.tolerance, 1024 * epsilon);
    vanished += of_first_link;
  }
  EXPECT_EQ(vanished, 3);
}

struct Case {
  const char *name, *robot;
  Settings settings;
};

class RightCode : public testing::TestWithParam<Case> {};

TEST_P(RightCode, PassesItsSelfTest) { EXPECT_EQ(run(read_robot(GetParam().robot, GetParam().settings)), ""); }

INSTANTIATE_TEST_SUITE_P(
    Scenes, RightCode,
    testing::Values(
        Case{"run_time_inputs",
             "prismatic_mix",
             {{"base", "floating"},
              {"gravity", "run_time"},
              {"payloads", "base,link_4"},
              {"jacobians", "link_5"},
              {"outputs", "mass_matrix,coriolis_matrix,gravity,bias,wrench_influence"}}},
        Case{"driven_joints_with_friction",
             "prismatic_mix",
             {{"base", "fixed"},
              {"mimic", "{link_4_joint: {of: link_2_joint, multiplier: -1.5, offset: 0.1}}"},
              {"outputs", "mass_matrix,bias,forward_dynamics_dq,forward_dynamics,forward_dynamics_dv"},
              {"armature", "link_1_joint=0.2"},
              {"damping", "link_4_joint=0.3"},
              {"friction", "link_5_joint=0.4"}}},
        Case{"springs",
             "prismatic_mix",
             {{"stiffness", "{link_1_joint: 30, link_4_joint: {k: 2e5, rest: 0.1}}"},
              {"outputs",
               "bias,potential_energy,inverse_dynamics,inverse_dynamics_dq,forward_dynamics,forward_dynamics_dq,forward_"
               "dynamics_dv"}}},
        Case{"elastic_joints",
             "quadruped",
             {{"elastic",
               "{front_left_2_thigh_joint: {k: 800, inertia: 0.05}, hind_right_3_shank_joint: {k: 2e5, inertia: 1e-3, damping: "
               "4}}"},
              {"outputs",
               "mass_matrix,bias,kinetic_energy,potential_energy,inverse_dynamics_dq,forward_dynamics,inverse_mass_matrix"}}},
        Case{"vanishing", "skew_axes", vanishing},
        Case{"springs_in_statics",
             "quadruped",
             {{"rates_zero", "true"}, {"stiffness", "front_left_2_thigh_joint=30"}, {"outputs", "bias"}}},
        Case{"statics", "quadruped", {{"rates_zero", "true"}, {"outputs", "gravity,bias"}}},
        Case{"no_gravity", "quadruped", {{"gravity", "none"}, {"outputs", "gravity,bias"}}},
        Case{"turntables", "two_branches_at_base", {{"base", "fixed"}, {"cut", "a_02,b_02"}, {"outputs", "coriolis_matrix"}}},
        Case{"lone_base",
             "two_branches_at_base",
             {{"base", "floating"}, {"cut", "a_01,b_01"}, {"payloads", "base"}, {"outputs", "gravity,mass_matrix"}}}),
    [](const auto& info) { return info.param.name; });

// A chain whose last link is heavier or lighter, longer or shorter than the others by many powers of ten, in double and float.
TEST(RightCodeOf, ExtremeRobotsPasses) {
  for (const char* scalar : {"double", "float"})
    for (const auto& [mass, length] : {std::pair{1e9, 1.0}, {1e-9, 1.0}, {1.0, 1e6}, {1.0, 1e-6}}) {
      Model model = read_robot("skew_chain_10", {{"base", "fixed"}, {"scalar", scalar}});
      ir::Body& tip = model.tree.bodies.back();
      tip.inertia.mass *= mass;
      tip.inertia.com *= length;
      tip.inertia.inertia *= mass * length * length;
      EXPECT_EQ(run(model), "") << scalar << ": mass " << mass << ", length " << length;
    }
}

}  // namespace
}  // namespace dalembert
