// What the report says of extreme states: what reads the base's position is measured there, all else must not change by a bit.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "commands/random_states.hpp"
#include "commands/report/extreme_states.hpp"
#include "commands/report/stability.hpp"
#include "costs.hpp"
#include "left_out.hpp"
#include "read_robot.hpp"

namespace dalembert::reporting {
namespace {

const CompilerOptions compiler{.compiler = "", .flags = "-std=c++17 -O0 " PRECOMPILED_EIGEN};

// By quantity: the metrics of one case in double.
using Case = std::map<std::string, std::map<std::string, std::string>>;

std::vector<Row> stability_of(const Model& model, const CompilerOptions& options = compiler) {
  const Mujoco mujoco(model, options);
  const Pinocchio pinocchio(model);
  Rows rows;
  const Subject subject{model, outputs_of(model), options, true, mujoco, pinocchio};
  add_stability(subject, make_engines(stability_orders(subject)), rows);
  return rows.all();
}

Case case_of(const std::vector<Row>& rows, const std::string& name, const std::string& variant) {
  Case found;
  for (const Row& row : rows)
    if (row.section == "stability" && row.subject == name && row.variant == variant)
      found[row.quantity][row.metric] = row.value;
  return found;
}

TEST(ReportStability, KnowsWhatReadsTheBasesPosition) {
  const Model model = read_robot("skew_axes", {{"base", "floating"},
                                               {"outputs", "center_of_mass,potential_energy,center_of_mass_jacobian,gravity"},
                                               {"frames", "{link_3: [pose, jacobian]}"}});
  std::map<std::string, bool> position, pose;
  for (const OperationCost& cost : operation_costs(model)) {
    position[cost.name] = cost.reads_base_position;
    pose[cost.name] = cost.reads_base_pose;
  }
  EXPECT_EQ(position, (std::map<std::string, bool>{{"all", true},
                                                   {"center_of_mass", true},
                                                   {"potential_energy", true},
                                                   {"center_of_mass_jacobian", false},
                                                   {"gravity", false},
                                                   {"pose_link_3", true},
                                                   {"jacobian_link_3", false}}));
  EXPECT_TRUE(pose["gravity"] && pose["center_of_mass"]);
}

TEST(ReportStability, SaysThatTheBasesPositionIsNotReadOnlyWhereItIsNot) {
  const Model model = read_robot("skew_axes", {{"base", "floating"}, {"outputs", "center_of_mass,gravity,kinetic_energy"}});
  std::map<std::string, std::string> said;
  for (const OperationCost& cost : operation_costs(model)) said[cost.name] = not_read(cost, model.tree);
  EXPECT_EQ(said, (std::map<std::string, std::string>{{"all", ""},
                                                      {"center_of_mass", "velocities"},
                                                      {"gravity", "base position, velocities"},
                                                      {"kinetic_energy", "base pose"}}));
}

TEST(ReportStability, FarAwayMeasuresWhatReadsTheBasesPositionAndComparesTheRest) {
  const std::vector<Row> rows = stability_of(read_robot(
      "skew_axes",
      {{"base", "floating"}, {"outputs", "center_of_mass,potential_energy,mass_matrix"}, {"frames", "{link_3: [pose]}"}}));
  for (const char* variant : {"generated double", "generated float"}) {
    const Case far = case_of(rows, "base at 1e12 m", variant);
    ASSERT_EQ(far.size(), 4) << variant;
    EXPECT_EQ(far.at("mass_matrix"), (std::map<std::string, std::string>{{"elements_changed", "0"}, {"verdict", "good"}}));
    for (const char* quantity : {"center_of_mass", "potential_energy", "pose_link_3"}) {
      ASSERT_EQ(far.at(quantity).count("ulp_worst"), 1) << quantity;
      EXPECT_LT(std::stod(far.at(quantity).at("ulp_worst")), 8) << quantity;
      EXPECT_EQ(far.at(quantity).at("verdict"), good) << quantity;
      EXPECT_EQ(far.at(quantity).count("elements_changed"), 0) << quantity;
    }
  }
}

constexpr const char* driven = "{link_2_joint: {of: link_1_joint, multiplier: -0.7, offset: 0.1}}";

// A compiler that rounds every constant to a float makes code in double bad, by a known measure.
TEST(ReportStability, WhatIsBadSaysWhatWasViolatedAndByHowMuch) {
  const Model model = read_robot("double_pendulum", {{"outputs", "gravity"}});
  const std::vector<Row> rows = stability_of(model, {.compiler = "", .flags = "-std=c++17 -O0 -fsingle-precision-constant"});
  const Case far = case_of(rows, "random states", "generated double");
  const auto& gravity = far.at("gravity");
  ASSERT_EQ(gravity.at("verdict"), bad);
  EXPECT_EQ(gravity.at("ulp_allowed"), "4096");
  EXPECT_NEAR(std::stod(gravity.at("times_allowed")), std::stod(gravity.at("ulp_worst")) / 4096,
              1e-9 * std::stod(gravity.at("times_allowed")));
  EXPECT_NE(gravity.at("violated").find("times as far from the exact result as the 4096 ulp that may be"), std::string::npos)
      << gravity.at("violated");
}

TEST(ReportStability, RoundedAnglesAreThoseThatTheScalarHolds) {
  const Model model = read_robot("skew_axes", {{"base", "fixed"}, {"mimic", driven}});
  const ir::KinematicTree& tree = model.tree;
  State state = random_states(tree, 1).front();
  for (const double q : {0.3, 1e6 / 3, -1e15 / 3}) {
    state.q[0] = q;
    const auto offset = [&](ir::ScalarType scalar, bool fused) {
      return with_rounded_angles(tree, state, scalar, fused).bodies[1].offset;
    };
    const auto angle = [&](double offset) { return std::fma(-0.7, q, offset); };
    const volatile double product = -0.7 * q;
    EXPECT_EQ(angle(offset(ir::ScalarType::float64, true)), std::fma(-0.7, q, 0.1));
    EXPECT_EQ(angle(offset(ir::ScalarType::float64, false)), product + 0.1);
    const double single = angle(offset(ir::ScalarType::float32, true));
    EXPECT_EQ(single, static_cast<float>(single));
  }
}

TEST(ReportStability, DrivenAnglesThatAreLargeAreJudgedAsRounded) {
  const Model model =
      read_robot("skew_axes", {{"base", "floating"}, {"outputs", "mass_matrix,center_of_mass"}, {"mimic", driven}});
  const std::vector<Row> rows = stability_of(model);
  for (const char* variant : {"generated double", "generated float"})
    for (const char* name : {"angles to 1e6 rad", "angles to 1e15 rad"}) {
      const Case judged = case_of(rows, name, variant);
      EXPECT_EQ(judged.size(), 2) << variant << ", " << name;
      for (const auto& [quantity, metrics] : judged)
        EXPECT_EQ(metrics.at("verdict"), good)
            << variant << ", " << name << ", " << quantity << ": " << metrics.at("ulp_worst");
    }
}

}  // namespace
}  // namespace dalembert::reporting
