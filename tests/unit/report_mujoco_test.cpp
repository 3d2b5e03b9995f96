// Other programs beside the generated code in a report: the same quantities, in our coordinates, and why not where they have
// them not.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <robots.hpp>

#include "commands/random_states.hpp"
#include "commands/report/errors.hpp"
#include "commands/report/mujoco.hpp"
#include "commands/report/mujoco_model.hpp"
#include "commands/report/pinocchio.hpp"
#include "commands/report/subject.hpp"
#include "commands/temporary_folder.hpp"
#include "read_robot.hpp"

namespace dalembert::reporting {
namespace {

const CompilerOptions compiler{.compiler = "", .flags = "-std=c++17 -O0 " PRECOMPILED_EIGEN};
constexpr const char* computed =
    "mass_matrix,gravity,bias,inverse_dynamics,forward_dynamics,inverse_mass_matrix,kinetic_energy,potential_energy,"
    "center_of_mass,center_of_mass_jacobian";

// The largest norm-wise error of any output at a few states.
double worst_error(const Model& model) {
  const Mujoco mujoco(model, compiler);
  EXPECT_TRUE(mujoco.found()) << mujoco.why_not_found();
  const std::vector<Output> outputs = outputs_of(model);
  double worst = 0;
  for (const State& state : random_states(model.tree, 4)) {
    const Exact exact = exact_at(model, outputs, state);
    for (size_t o = 0; o < outputs.size(); ++o) {
      EXPECT_EQ(mujoco.obstacle(outputs[o]), "");
      const Eigen::MatrixXd result = mujoco.result(outputs[o], state);
      const double error = error_of(result, exact.results[o], exact.least_scales[o], ir::ScalarType::float64).norm;
      EXPECT_LT(error, 1e-12) << outputs[o].name;
      worst = std::max(worst, error);
    }
  }
  return worst;
}

TEST(ReportMujoco, ComputesTheSameOnAFloatingBaseWithBranches) {
  EXPECT_GT(worst_error(read_robot("two_branches_at_base", {{"base", "floating"}, {"outputs", computed}})), 0);
}

TEST(ReportMujoco, ComputesTheSameOnAFixedBaseWithArmatureDampersSpringsAndAnotherGravity) {
  EXPECT_GT(worst_error(read_robot("prismatic_mix", {{"base", "fixed"},
                                                     {"outputs", computed},
                                                     {"gravity", "1,2,-9"},
                                                     {"armature", "{link_1_joint: 0.3, link_4_joint: 0.05}"},
                                                     {"damping", "{link_2_joint: 0.7}"},
                                                     {"stiffness", "{link_3_joint: {k: 300, rest: 0.1}, link_4_joint: 20}"}})),
            0);
}

TEST(ReportMujoco, ComputesTheSameWithoutSpeeds) {
  EXPECT_GT(worst_error(
                read_robot("two_levels_of_branching", {{"rates_zero", "true"}, {"outputs", "gravity,bias,inverse_dynamics"}})),
            0);
}

TEST(ReportMujoco, ComputesTheSameOfASingleBody) {
  EXPECT_GT(worst_error(read_robot("skew_axes", {{"base", "floating"}, {"cut", "link_1"}, {"outputs", computed}})), 0);
}

TEST(ReportMujoco, TimesWhatItComputes) {
  const Model model = read_robot("chain_7", {{"outputs", "mass_matrix"}});
  const CallTime time = Mujoco(model, compiler).time_per_call(outputs_of(model).front(), random_states(model.tree, 20));
  EXPECT_GT(time.lower_quartile, 10);
  EXPECT_LE(time.lower_quartile, time.median);
  EXPECT_LE(time.median, time.upper_quartile);
}

// Per output what stands in its way.
std::vector<std::string> obstacles(const std::string& robot, const Settings& settings) {
  const Model model = read_robot(robot, settings);
  const Mujoco mujoco(model, compiler);
  EXPECT_TRUE(mujoco.found()) << mujoco.why_not_found();
  std::vector<std::string> list;
  for (const Output& output : outputs_of(model)) list.push_back(mujoco.obstacle(output).substr(0, 20));
  return list;
}

TEST(ReportMujoco, SaysWhatItHasNot) {
  using List = std::vector<std::string>;
  EXPECT_EQ(obstacles("chain_7", {{"outputs", "mass_matrix,coriolis_matrix"}}), (List{"", "the report asks MuJo"}));
  EXPECT_EQ(obstacles("skew_axes", {{"base", "fixed"},
                                    {"mimic", "{link_2_joint: {of: link_1_joint, multiplier: 0.5}}"},
                                    {"outputs", "mass_matrix,bias"}}),
            (List{"there are mimic join", "there are mimic join"}));
  EXPECT_EQ(
      obstacles("skew_axes", {{"friction", "{link_2_joint: 1}"}, {"outputs", "mass_matrix,gravity,bias,inverse_dynamics"}}),
      (List{"", "", "Coulomb friction is ", "Coulomb friction is "}));
  EXPECT_EQ(obstacles("skew_axes", {{"wrenches", "{link_3: world}"}, {"outputs", "bias,forward_dynamics"}}),
            (List{"", "there are external f"}));
  EXPECT_EQ(obstacles("skew_axes", {{"payloads", "[link_3]"}, {"outputs", "bias"}}), (List{"payloads are given a"}));
  EXPECT_EQ(obstacles("skew_axes", {{"outputs", "[]"}, {"functions", "{both: [mass_matrix, bias], one: [bias]}"}}),
            (List{"one call computes th", "one call computes th", ""}));
}

TEST(ReportMujoco, SaysThatItIsNotFound) {
  const TemporaryFolder folder;
  const std::string wrapper = (folder.path() / "compiler").string();
  std::ofstream(wrapper) << "#!/bin/sh\necho 'somewhere: cannot find -lmujoco: No such file or directory' >&2\nexit 1\n";
  std::filesystem::permissions(wrapper, std::filesystem::perms::owner_all);
  const Mujoco mujoco(read_robot("chain_7", {}), {.compiler = wrapper});
  EXPECT_FALSE(mujoco.found());
  EXPECT_EQ(mujoco.why_not_found(), "cannot find -lmujoco: No such file or directory");
}

TEST(ReportMujoco, SaysThatItRefusesTheModel) {
  Model model = read_robot("chain_7", {{"base", "fixed"}, {"outputs", "mass_matrix"}});
  while (model.tree.bodies.size() < 2000) {  // deeper than its reader of XML goes
    model.tree.bodies.push_back(model.tree.bodies.back());
    model.tree.bodies.back().parent = static_cast<int>(model.tree.bodies.size()) - 2;
  }
  const Mujoco mujoco(model, compiler);
  EXPECT_TRUE(mujoco.found());
  EXPECT_TRUE(mujoco.obstacle(outputs_of(model).front()).starts_with("MuJoCo refuses the model: "))
      << mujoco.obstacle(outputs_of(model).front());
}

// Where there is no library, nothing is missing: a report has neither its figures nor a word of it.
TEST(ReportPinocchio, IsNotMissedWhereItIsNotFound) {
  const char* const given = std::getenv("DALEMBERT_PINOCCHIO");
  const std::string before = given ? given : "";
  setenv("DALEMBERT_PINOCCHIO", "/nowhere/libdalembert_pinocchio.so", 1);
  EXPECT_FALSE(Pinocchio(read_robot("chain_7", {})).found());
  given ? setenv("DALEMBERT_PINOCCHIO", before.c_str(), 1) : unsetenv("DALEMBERT_PINOCCHIO");
}

// Of one quantity: the largest difference from 50 digits, and where it was.
struct Agreement {
  int compared = 0;
  double worst = 0, condition = 0;  // the latter of M, where it is solved with
  std::string where;
};

void print_agreement(const std::string& version, const std::vector<std::pair<std::string, Agreement>>& list) {
  fmt::print(
      "Pinocchio {}\n\n| quantity | compared | largest difference | at | condition of M there |\n|---|---:|---:|---|---:|\n",
      version);
  for (const auto& [quantity, own] : list)
    fmt::print("| `{}` | {} | {:.1e} | {} | {} |\n", quantity, own.compared, own.worst, own.where,
               own.condition > 0 ? fmt::format("{:.0e}", own.condition) : "");
}

// Every quantity that it has, of every robot, with either base: to 1e-9 of the largest element. Prints the table of
// docs/report.md.
TEST(ReportPinocchio, AgreesOnEveryQuantityAndRobotWhereItIsFound) {
  const Pinocchio any(read_robot("chain_7", {}));
  if (!any.found()) GTEST_SKIP() << "configure with -DDALEMBERT_PINOCCHIO=FOLDER and build dalembert_pinocchio";
  const std::string all =
      "mass_matrix,coriolis_matrix,gravity,bias,inverse_dynamics,inverse_dynamics_dq,inverse_dynamics_dv,forward_dynamics,"
      "forward_dynamics_dq,forward_dynamics_dv,inverse_mass_matrix,momentum_matrix,center_of_mass,center_of_mass_jacobian,"
      "kinetic_energy,potential_energy,regressor";
  std::vector<std::pair<std::string, Agreement>> agreement;
  for (const TestRobot& robot : test_robots)
    for (const char* base : {"fixed", "floating"}) {
      const std::string where = std::string(robot.name) + ", " + base;
      SCOPED_TRACE(where);
      try {
        Settings settings{{"base", base}, {"outputs", all}, {"coriolis", "christoffel"}, {"gravity", "0.3,-0.2,-9.7"}};
        Model model = read_robot(robot.name, settings);
        const Pinocchio bare(model);
        const Model without_armature = model;
        for (size_t k = 0; k < model.tree.bodies.size(); k += 3) model.tree.bodies[k].armature = 0.2;
        const Pinocchio loaded(model);
        const std::vector<Output> outputs = outputs_of(model);
        for (const Output& output : outputs)
          if (agreement.size() < outputs.size()) agreement.emplace_back(output.name, Agreement{});
        for (const State& state : random_states(model.tree, 2)) {
          const Exact with_armature = exact_at(model, outputs, state);
          for (size_t o = 0; o < outputs.size(); ++o) {
            // Its kinetic energy lacks armatures about oblique axes: there the robot has none.
            const bool oblique = outputs[o].quantity == ir::Quantity::kinetic_energy && !loaded.obstacle(outputs[o]).empty();
            const Pinocchio& pinocchio = oblique ? bare : loaded;
            const Exact own_exact = oblique ? exact_at(without_armature, {outputs[o]}, state) : Exact{};
            const Eigen::MatrixXd& exact = oblique ? own_exact.results.front() : with_armature.results[o];
            const double least_scale = oblique ? own_exact.least_scales.front() : with_armature.least_scales[o];
            ASSERT_EQ(pinocchio.obstacle(outputs[o]), "") << outputs[o].name;
            const double condition = reference::condition({outputs[o].quantity, ""}, model.tree, model.scene,
                                                          {state.q, state.v, state.more, state.wrenches});
            if (!std::isfinite(condition)) continue;
            // Where the exact result vanishes, rounding of larger terms is left.
            const double error =
                error_of(pinocchio.result(outputs[o], state), exact, std::max(least_scale, 1e-6), ir::ScalarType::float64).norm;
            EXPECT_LE(error, 1e-9) << outputs[o].name;
            Agreement& own = agreement[o].second;
            ++own.compared;
            if (error > own.worst) own = {own.compared, error, condition, where};
          }
        }
      } catch (const InputError&) {
        // A floating base without inertia.
      }
    }
  print_agreement(any.version() + ", compiled by " + any.compiled(), agreement);
  int compared = 0;
  for (const auto& [quantity, own] : agreement) compared += own.compared;
  EXPECT_GE(compared, 1000);
}

TEST(ReportPinocchio, SaysWhatItHasNot) {
  Model model = read_robot(
      "skew_axes", {{"base", "fixed"}, {"outputs", "coriolis_matrix,bias,wrench_influence"}, {"damping", "{link_2_joint: 1}"}});
  const Pinocchio pinocchio(model);
  if (!pinocchio.found()) GTEST_SKIP();
  std::vector<std::string> said;
  for (const Output& output : outputs_of(model)) said.push_back(pinocchio.obstacle(output).substr(0, 20));
  EXPECT_EQ(said, (std::vector<std::string>{"Pinocchio's C is of ", "Pinocchio's function", "the report asks Pino"}));
}

TEST(ReportMujoco, ReadsBodiesWithinThoseThatCarryThem) {
  const std::string text = mujoco_model(read_robot("two_levels_of_branching", {{"base", "fixed"}}).tree, {});
  const auto count = [&](const std::string& word) {
    size_t times = 0;
    for (size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1)) ++times;
    return times;
  };
  EXPECT_EQ(count("<body "), count("</body>"));
  EXPECT_EQ(count("<body "), count("<joint "));
}

}  // namespace
}  // namespace dalembert::reporting
