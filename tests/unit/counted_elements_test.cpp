// Elements of matrices that are counted and forgotten: the counts are those of the program that has them all, and what is left
// of the program grows with the robot and not with its square.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "both_forms.hpp"
#include "costs.hpp"
#include "ir/joint_types.hpp"

namespace dalembert {
namespace {

using ir::Quantity;

std::string text(const ir::Operations& o) {
  std::ostringstream text;
  text << o.add << " + " << o.multiply << " * " << o.divide << " / " << o.sincos << " sincos";
  return text.str();
}

std::string text(const std::vector<OperationCost>& costs) {
  std::ostringstream all;
  for (const OperationCost& cost : costs) {
    all << cost.name << ": " << text(cost.operations);
    for (const ir::Operations& phase : cost.phases) all << "; " << text(phase);
    all << "; " << cost.reads_position << cost.reads_velocity << cost.reads_base_pose << cost.reads_base_position;
    for (const auto* list : {&cost.positions_not_read, &cost.velocities_not_read}) {
      all << ";";
      for (const int index : *list) all << " " << index;
    }
    all << "\n";
  }
  return all.str();
}

long nodes(const Lowered& lowered) {
  long sum = 0;
  for (const LoweredSection* section : lowered.all_sections()) sum += section->program.graph.size();
  return sum;
}
long forgotten(const Lowered& lowered) {
  long sum = 0;
  for (const LoweredSection* section : lowered.all_sections()) sum += section->program.counted.nodes;
  return sum;
}

void expect_same(const Model& model) {
  const Lowered kept = lower_to_programs(model, ir::Elements::kept), counted = lower_to_programs(model, ir::Elements::counted);
  EXPECT_EQ(text(operation_costs(counted, model.tree)), text(operation_costs(kept, model.tree)));
  // The order of elements is another, and with it which of two opposites is a node and which its negative.
  EXPECT_NEAR(static_cast<double>(nodes(counted) + forgotten(counted)), static_cast<double>(nodes(kept)), 10);
}

// Matrices that share operations with each other, and with sweeps that come after them.
const std::vector<std::vector<Quantity>> outputs = {
    {Quantity::mass_matrix, Quantity::coriolis_matrix},
    {Quantity::forward_dynamics, Quantity::mass_matrix, Quantity::inverse_mass_matrix, Quantity::regressor},
    {Quantity::inverse_dynamics_dq, Quantity::inverse_dynamics_dv, Quantity::forward_dynamics_dq, Quantity::coriolis_matrix},
};

class CountedElements : public testing::TestWithParam<TestRobot> {};

TEST_P(CountedElements, AreAsManyAsThereAre) {
  const ir::RobotDescription description = robot(GetParam().name);
  for (const std::vector<Quantity>& asked : outputs) {
    ir::Scene scene;
    scene.outputs = asked;
    Model model = model_of(description, scene);
    if (model.tree.joints() > 30) return;
    expect_same(model);
    model.options.fold = model.options.share = model.options.move_parameters = false;
    expect_same(model);
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, CountedElements, testing::ValuesIn(test_robots),
                         [](const auto& info) { return std::string(info.param.name); });

// One joint after another, on a fixed base. Every fifth slides; axes are askew.
ir::RobotDescription chain(int joints) {
  ir::RobotDescription robot;
  robot.name = "chain";
  robot.root = 0;
  robot.children.resize(static_cast<size_t>(joints) + 1);
  for (int i = 0; i <= joints; ++i) {
    ir::Link link;
    link.name = "l" + std::to_string(i);
    link.inertia = ir::Inertia{1.0 + i % 7, {0.1, 0.02 * (i % 3), 0.03}, Eigen::Vector3d(0.02, 0.03, 0.04).asDiagonal()};
    robot.links.push_back(link);
  }
  for (int i = 0; i < joints; ++i) {
    ir::Joint joint;
    joint.name = "j" + std::to_string(i);
    joint.type = i % 5 == 4 ? ir::JointType::prismatic : ir::JointType::revolute;
    joint.parent = i, joint.child = i + 1;
    joint.axis = Eigen::Vector3d(std::sin(i), std::cos(i), 0.3).normalized();
    joint.origin.translation() = Eigen::Vector3d(0.1, 0.2, 0.3);
    robot.joints.push_back(joint);
    robot.children[static_cast<size_t>(i)] = {i};
  }
  return robot;
}

TEST(CountedElements, LeaveAProgramThatGrowsWithTheRobot) {
  for (const std::vector<Quantity>& asked : outputs) {
    const auto lowered = [&](int joints) {
      ir::Scene scene;
      scene.base = ir::Base::fixed;
      scene.outputs = asked;
      return lower_to_programs(model_of(chain(joints), scene));
    };
    const Lowered few = lowered(50), many = lowered(100);
    EXPECT_LT(10 * nodes(many), 21 * nodes(few));
    EXPECT_GT(forgotten(many), 3 * forgotten(few));
  }
}

// Of straight lines, whose rows lanes give: the line without them is what elements are counted in.
TEST(CountedElements, OfProjectionsByRows) {
  for (const ir::Base base : {ir::Base::fixed, ir::Base::floating})
    for (const std::vector<Quantity>& asked :
         {std::vector<Quantity>{Quantity::regressor}, std::vector<Quantity>{Quantity::inverse_dynamics, Quantity::regressor}}) {
      ir::Scene scene;
      scene.base = base;
      scene.outputs = asked;
      Model model = model_of(chain(9), scene);
      model.options.refer = false;  // elements are counted by the first body's frame
      const std::vector<OperationCost> in_line = operation_costs(lower_to_programs(model), model.tree);
      model.options.form = ir::Form::straight;
      const Lowered straight = lower(model);
      ASSERT_FALSE(straight.functions.front().first().algorithm.projections.front().by_rows.empty());
      const std::vector<OperationCost> by_rows = operation_costs(straight, model.tree);
      ASSERT_EQ(by_rows.size(), in_line.size());
      for (size_t i = 0; i < by_rows.size(); ++i) {  // a few that rows read belong to another phase
        EXPECT_EQ(text(by_rows[i].operations), text(in_line[i].operations));
        EXPECT_EQ(by_rows[i].positions_not_read, in_line[i].positions_not_read);
        EXPECT_EQ(by_rows[i].velocities_not_read, in_line[i].velocities_not_read);
      }
    }
}

// Lanes give a body's columns where straight lines, which know more zeros, would take longer: not of a planar arm.
TEST(CountedElements, LanesLeavePlanarArmsToStraightLines) {
  const auto bodies_in_lanes = [](bool planar) {
    ir::RobotDescription robot = chain(4);
    if (planar)
      for (ir::Joint& joint : robot.joints) joint.axis = Eigen::Vector3d::UnitZ();
    ir::Scene scene;
    scene.base = ir::Base::fixed;
    scene.outputs = {Quantity::regressor};
    Model model = model_of(robot, scene);
    model.options.form = ir::Form::straight;
    return lower(model).functions.front().first().algorithm.projections.front().by_rows.size();
  };
  EXPECT_GT(bodies_in_lanes(false), 0u);
  EXPECT_EQ(bodies_in_lanes(true), 0u);
}

// What parts of such a joint do to each other is added to elements that are there.
TEST(CountedElements, OfJointsWithQuaternions) {
  for (const std::vector<Quantity>& asked : outputs)
    for (const ir::Base base : {ir::Base::fixed, ir::Base::floating}) {
      ir::Scene scene;
      scene.base = base;
      scene.outputs = asked;
      ir::RobotDescription robot = chain(6);
      robot.joints[1].type = ir::JointType::spherical;
      robot.joints[3].type = ir::JointType::floating;
      expect_same(model_of(robot, scene));
    }
}

// Elements are sums where joints follow others.
TEST(CountedElements, OfJointsThatFollowOthers) {
  for (const std::vector<Quantity>& asked : outputs) {
    ir::Scene scene;
    scene.base = ir::Base::fixed;
    scene.outputs = asked;
    scene.forward_dynamics = ir::Solver::factorization;
    scene.mimic["j12"] = {"j3", 0.5, 0.1};
    expect_same(model_of(chain(20), scene));
  }
}

}  // namespace
}  // namespace dalembert
