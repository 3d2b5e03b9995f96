// What a scene leaves out, counted in the scalar program: operation for operation, without compiling any code.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <robots.hpp>

#include "compile.hpp"
#include "costs.hpp"
#include "frontend/urdf_reader.hpp"
#include "ir/rotation.hpp"
#include "passes/build_tree.hpp"

namespace dalembert {
namespace {

using ir::Quantity;

ir::RobotDescription read(const std::string& file) {
  Diagnostics warnings;
  return frontend::read_urdf(file, warnings);
}

const TestRobot* robot_named(std::string_view name) {
  const auto at =
      std::find_if(std::begin(test_robots), std::end(test_robots), [&](const TestRobot& r) { return r.name == name; });
  return at == std::end(test_robots) ? nullptr : at;
}

std::vector<OperationCost> costs(const ir::RobotDescription& robot, const ir::Scene& scene) {
  Diagnostics warnings;
  Model model;
  model.scene = scene;
  model.tree = passes::build_tree(robot, scene, warnings);
  return operation_costs(model);
}

OperationCost cost(const ir::RobotDescription& robot, ir::Scene scene, std::vector<Quantity> outputs) {
  scene.outputs = std::move(outputs);
  return costs(robot, scene).front();
}

ir::Scene fixed_base() {
  ir::Scene scene;
  scene.base = ir::Base::fixed;
  return scene;
}

// The bases the robot can stand on: none floats without inertia.
std::vector<ir::Base> bases_of(const ir::RobotDescription& robot) {
  std::vector<ir::Base> bases{ir::Base::fixed};
  ir::Scene floating;
  floating.base = ir::Base::floating;
  try {
    cost(robot, floating, {Quantity::gravity});
    bases.push_back(ir::Base::floating);
  } catch (const InputError&) {
  }
  return bases;
}

using Counts = std::array<long, 4>;
Counts counts(const ir::Operations& o) { return {o.add, o.multiply, o.divide, o.sincos}; }

bool at_most(const ir::Operations& a, const ir::Operations& b) { return a.total() <= b.total() && a.sincos <= b.sincos; }

void expect_same_counts(const std::vector<OperationCost>& a, const std::vector<OperationCost>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].name, b[i].name);
    EXPECT_EQ(counts(a[i].operations), counts(b[i].operations)) << a[i].name;
  }
}

class SceneOperations : public testing::TestWithParam<TestRobot> {};

// A joint fixed where it is locked: at zero with its origin, elsewhere with the origin turned or moved along the axis.
TEST_P(SceneOperations, LockingCostsWhatTheUrdfWithFixedJointsDoes) {
  const ir::RobotDescription robot = read(GetParam().urdf);
  for (double value : {0.0, 0.4}) {
    ir::RobotDescription fixed = robot;
    ir::Scene locked;
    for (size_t i = 0; i < robot.joints.size(); i += 2) {
      ir::Joint& joint = fixed.joints[i];
      if (joint.type == ir::JointType::fixed) continue;
      if (joint.type == ir::JointType::prismatic) joint.origin.translate(joint.axis * value);
      else joint.origin.rotate(ir::rotation_about(joint.axis, value));
      joint.type = ir::JointType::fixed;
      locked.locked[joint.name] = value;
    }
    expect_same_counts(costs(robot, locked), costs(fixed, {}));
  }
}

TEST_P(SceneOperations, CuttingCostsWhatTheUrdfWithoutTheSubtreeDoes) {
  const ir::RobotDescription robot = read(GetParam().urdf);
  for (size_t j = 1; j < robot.joints.size(); j += std::max<size_t>(1, robot.joints.size() / 3)) {
    ir::RobotDescription shorter = robot;
    std::erase(shorter.children[static_cast<size_t>(robot.joints[j].parent)], static_cast<int>(j));
    ir::Scene scene;
    scene.cut.insert(robot.links[static_cast<size_t>(robot.joints[j].child)].name);
    expect_same_counts(costs(robot, scene), costs(shorter, {}));
  }
}

// All 2⁴ choices of M, C, g and C v + g: none costs more than a choice with one quantity more.
TEST_P(SceneOperations, NoSubsetOfTheOutputsCostsMoreThanItsSuperset) {
  const ir::RobotDescription robot = read(GetParam().urdf);
  const std::vector<Quantity> all = ir::Scene{}.outputs;
  ASSERT_EQ(all.size(), 4u);
  for (const ir::Base base : bases_of(robot)) {
    ir::Scene scene;
    scene.base = base;
    std::vector<ir::Operations> of(16);
    for (unsigned set = 1; set < 16; ++set) {
      std::vector<Quantity> outputs;
      for (unsigned i = 0; i < 4; ++i)
        if (set & 1u << i) outputs.push_back(all[i]);
      of[set] = cost(robot, scene, outputs).operations;
    }
    for (unsigned set = 1; set < 16; ++set)
      for (unsigned i = 0; i < 4; ++i) EXPECT_TRUE(at_most(of[set], of[set | 1u << i])) << set << " and " << i;
  }
}

// The same for the emitted code's workspace: results, and what is kept between the stages of the rolled form. Form by form:
// what is left to choice goes by time, and a superset may be a straight line where its subset is loops.
TEST_P(SceneOperations, NoSubsetOfTheOutputsTakesMoreRoomThanItsSuperset) {
  Diagnostics warnings;
  Request request;
  request.robot = GetParam().urdf;
  Model model = read_model(request, warnings);
  const std::vector<Quantity> all = ir::Scene{}.outputs;
  for (const ir::Form form : {ir::Form::straight, ir::Form::rolled}) {
    model.options.form = form;
    std::vector<size_t> bytes(16);
    for (unsigned set = 1; set < 16; ++set) {
      model.scene.outputs.clear();
      for (unsigned i = 0; i < 4; ++i)
        if (set & 1u << i) model.scene.outputs.push_back(all[i]);
      bytes[set] = workspace_bytes(model, lower(model));
    }
    for (unsigned set = 1; set < 16; ++set)
      for (unsigned i = 0; i < 4; ++i)
        EXPECT_LE(bytes[set], bytes[set | 1u << i]) << set << " and " << i << ", form " << static_cast<int>(form);
  }
}

// What is the same in both bases and whatever the robot.
TEST_P(SceneOperations, QuantitiesReadOnlyWhatTheyDependOn) {
  const ir::RobotDescription robot = read(GetParam().urdf);
  for (const ir::Base base : bases_of(robot)) {
    ir::Scene scene;
    scene.base = base;
    const OperationCost mass = cost(robot, scene, {Quantity::mass_matrix});
    EXPECT_FALSE(mass.reads_velocity);
    EXPECT_FALSE(mass.reads_base_pose);
    EXPECT_FALSE(cost(robot, scene, {Quantity::coriolis_matrix}).reads_base_pose);
    EXPECT_FALSE(cost(robot, scene, {Quantity::gravity}).reads_velocity);
    scene.gravity_kind = ir::GravityKind::none;
    const OperationCost weightless = cost(robot, scene, {Quantity::gravity});
    EXPECT_EQ(counts(weightless.operations), (Counts{0, 0, 0, 0}));
    EXPECT_FALSE(weightless.reads_position || weightless.reads_base_pose);
    EXPECT_FALSE(cost(robot, scene, {Quantity::bias}).reads_base_pose);
    scene.gravity_kind = ir::GravityKind::constant;
    scene.rates_zero = true;
    const OperationCost statics = cost(robot, scene, {Quantity::bias});
    EXPECT_FALSE(statics.reads_velocity);
    EXPECT_EQ(counts(statics.operations), counts(cost(robot, scene, {Quantity::gravity}).operations));
    scene.rates_zero = false;
    EXPECT_TRUE(at_most(statics.operations, cost(robot, scene, {Quantity::bias}).operations));
  }
}

TEST_P(SceneOperations, NoGravityCostsNoMoreThanSomeAndConstantsNoMoreThanInputs) {
  const ir::RobotDescription robot = read(GetParam().urdf);
  std::map<ir::GravityKind, ir::Operations> of;
  for (const auto kind : {ir::GravityKind::none, ir::GravityKind::constant, ir::GravityKind::run_time}) {
    ir::Scene scene = fixed_base();
    scene.gravity_kind = kind;
    of[kind] = costs(robot, scene).front().operations;
  }
  EXPECT_TRUE(at_most(of[ir::GravityKind::none], of[ir::GravityKind::constant]));
  EXPECT_TRUE(at_most(of[ir::GravityKind::constant], of[ir::GravityKind::run_time]));
}

INSTANTIATE_TEST_SUITE_P(Robots, SceneOperations, testing::ValuesIn(test_robots),
                         [](const auto& info) { return std::string(info.param.name); });

// Every operation belongs to a phase, and nothing costs more than before.
TEST_P(SceneOperations, PhasesAddUpAndPassesOnlyRemove) {
  Diagnostics warnings;
  Request request;
  request.robot = GetParam().urdf;
  const Model model = read_model(request, warnings);
  for (const std::vector<OperationCost>& list : {operation_costs(model), costs_before(model)})
    for (const OperationCost& cost : list) {
      ir::Operations sum;
      for (const ir::Operations& phase : cost.phases) sum += phase;
      EXPECT_EQ(counts(sum), counts(cost.operations)) << cost.name;
    }
  const std::vector<PassCost> passes = pass_costs(model);
  ASSERT_EQ(passes.size(), 5u);
  for (size_t i = 1; i < passes.size(); ++i)
    EXPECT_TRUE(at_most(passes[i].operations, passes[i - 1].operations)) << passes[i].name;
  EXPECT_EQ(counts(passes.back().operations), counts(operation_costs(model).front().operations));
}

// The same as texts: what a user would write by hand.
TEST(SceneOperationsText, LockedAxisAlignedJointsCostWhatFixedOnesWithRpyDo) {
  const std::string body =
      "<inertial><origin xyz='0.1 0.02 0.3'/><mass value='2'/>"
      "<inertia ixx='0.1' ixy='0.01' ixz='0.02' iyy='0.2' iyz='0.03' izz='0.25'/></inertial>";
  const auto robot = [&](const std::string& type, const std::string& rpy) {
    std::string text = "<robot name='r'><link name='l0'>" + body + "</link>";
    for (int i = 1; i <= 5; ++i) {
      const std::string n = std::to_string(i), from = std::to_string(i - 1);
      const bool chosen = i == 1 || i == 3 || i == 4;
      text += "<link name='l" + n + "'>" + body + "</link><joint name='j" + n + "' type='" + (chosen ? type : "revolute") +
              "'><origin xyz='0.2 0 0.3' rpy='" + (chosen ? rpy : "0 0 0") + "'/><parent link='l" + from + "'/><child link='l" +
              n + "'/><axis xyz='" + (chosen ? "0 1 0" : "0 0 1") +
              "'/><limit lower='-3' upper='3' effort='1' velocity='1'/></joint>";
    }
    Diagnostics warnings;
    return frontend::read_urdf_text("r.urdf", text + "</robot>", warnings);
  };
  for (const auto& [value, rpy] : {std::pair{0.0, "0 0 0"}, {0.7, "0 0.7 0"}, {-1.1, "0 -1.1 0"}}) {
    ir::Scene locked;
    locked.locked = {{"j1", value}, {"j3", value}, {"j4", value}};
    expect_same_counts(costs(robot("revolute", "0 0 0"), locked), costs(robot("fixed", rpy), {}));
  }
}

TEST(SceneOperationsOfArms, GravityCostsAtMost35PercentOfBiasAndReadsNoVelocity) {
  for (const char* name : {"chain_7", "wam"}) {
    const TestRobot* arm = robot_named(name);
    if (!arm) continue;
    const ir::RobotDescription robot = read(arm->urdf);
    const OperationCost gravity = cost(robot, fixed_base(), {Quantity::gravity});
    const OperationCost bias = cost(robot, fixed_base(), {Quantity::bias});
    EXPECT_LE(static_cast<double>(gravity.operations.total()), 0.35 * static_cast<double>(bias.operations.total())) << name;
    EXPECT_FALSE(gravity.reads_velocity) << name;
    EXPECT_TRUE(bias.reads_velocity) << name;
    RecordProperty(std::string(name) + "_gravity", std::to_string(gravity.operations.total()));
    RecordProperty(std::string(name) + "_bias", std::to_string(bias.operations.total()));
  }
}

TEST(SceneOperationsOfArms, APlanarChainCostsAtMostAThirdOfASkewOne) {
  const ir::RobotDescription planar = read(robot_named("planar_chain_10")->urdf),
                             skew = read(robot_named("skew_chain_10")->urdf);
  for (const std::vector<Quantity>& outputs : std::vector<std::vector<Quantity>>{
           {Quantity::mass_matrix, Quantity::coriolis_matrix}, {Quantity::mass_matrix}, {Quantity::bias}}) {
    const long of_planar = cost(planar, fixed_base(), outputs).operations.total();
    const long of_skew = cost(skew, fixed_base(), outputs).operations.total();
    EXPECT_LE(3 * of_planar, of_skew) << name_of(outputs.front()) << ": " << of_planar << " and " << of_skew;
  }
}

TEST(SceneOperationsOfArms, TheMassMatrixOfAFixedBaseArmDoesNotReadTheFirstJoint) {
  for (const char* name : {"chain_7", "wam", "kr5"}) {
    const TestRobot* arm = robot_named(name);
    if (!arm) continue;
    const OperationCost mass = cost(read(arm->urdf), fixed_base(), {Quantity::mass_matrix});
    EXPECT_EQ(mass.positions_not_read, std::vector<int>{0}) << name;
  }
}

TEST(SceneFile, AskingForEverythingCostsNoMoreThanNoFile) {
  for (const TestRobot& robot : test_robots) {
    Diagnostics warnings;
    Request request;
    request.robot = robot.urdf;
    const Model without = read_model(request, warnings);
    request.settings = {{"outputs", "mass_matrix,coriolis_matrix,gravity,bias"},
                        {"gravity", "0,0,-9.81"},
                        {"base", ir::row_of(without.tree.base_joint).word},
                        {"rates_zero", "false"}};
    SCOPED_TRACE(robot.name);
    expect_same_counts(operation_costs(read_model(request, warnings)), operation_costs(without));
  }
}

}  // namespace
}  // namespace dalembert
