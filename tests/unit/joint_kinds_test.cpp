// Joints that are no hinge and no slide: all quantities, interpreted in both forms, against the generic engine, which
// oracle_dart_test and generic_dynamics_test hold to others.
#include "joint_kinds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <dalembert/generic/whole_robot.hpp>
#include <dalembert/integrators/rk4.hpp>

#include "both_forms.hpp"
#include "commands/generic_engine.hpp"
#include "frontend/urdf_reader.hpp"
#include "ir/constraint_paths.hpp"
#include "reference/generic_model.hpp"
#include "reference/instances.hpp"

namespace dalembert {
namespace {

ir::Scene everything(const KindsRobot& robot, bool floating) {
  ir::Scene scene;
  scene.base = floating ? ir::Base::floating : ir::Base::fixed;
  scene.gravity = {0.7, -1.3, -9.81};
  scene.joints = robot.joints;
  scene.outputs.clear();
  for (const ir::QuantityRow& row : ir::quantities())
    if (!ir::is_of_constraints(row.quantity)) scene.outputs.push_back(row.quantity);
  scene.jacobians = {"l6"};
  for (const ir::LinkQuantityRow& row : ir::link_quantities()) scene.frames.push_back({row.quantity, "l8"});
  return scene;
}

using KindAndBase = std::tuple<std::string, bool>;
class JointKinds : public testing::TestWithParam<KindAndBase> {
 protected:
  const KindsRobot robot = joint_kinds_robot(std::get<0>(GetParam()));
  ir::Scene scene = everything(robot, std::get<1>(GetParam()));
};

TEST_P(JointKinds, BothFormsGiveWhatTheGenericEngineGives) { expect_generic_values(model_of(robot.robot, scene), {}, 10); }

TEST_P(JointKinds, SoTheyDoByFactorsWithLossesAndOtherC) {
  scene.forward_dynamics = ir::Solver::factorization;
  scene.coriolis = ir::Coriolis::christoffel;
  for (const ir::Joint& joint : robot.robot.joints) {
    scene.armature[joint.name] = 0.3;
    scene.damping[joint.name] = 0.7;
    scene.friction[joint.name] = 0.4;
  }
  scene.stiffness["j6"] = {3, 0.4};
  scene.mimic["j11"] = {"j1", -0.5, 0.2};
  scene.payloads = {"l4"};
  scene.wrenches = {{"l5", false}, {"l10", true}, {"l4", true}};
  scene.contacts = {{"foot", "l6", ir::ContactType::weld, {0.1, -0.2, 0.05}, false},
                    {"toe", "l8", ir::ContactType::point, {0.02, 0.1, -0.3}, true}};
  scene.outputs.clear();
  for (const ir::QuantityRow& row : ir::quantities()) scene.outputs.push_back(row.quantity);
  expect_generic_values(model_of(robot.robot, scene), tool, 1000);
}

// A passive joint of several coordinates has no effort at any of them, where the contact can bear it.
TEST_P(JointKinds, ArePassiveWhole) {
  scene.contacts = {{"foot", "l6", ir::ContactType::weld, {0.1, -0.2, 0.05}, false}};
  scene.passive = {"j2"};
  scene.jacobians.clear();
  scene.frames.clear();
  scene.outputs = {ir::Quantity::constrained_inverse_dynamics};
  const Model model = model_of(robot.robot, scene);
  const std::vector<int> undriven = ir::undriven_coordinates(model.tree, model.scene);
  const auto base = static_cast<size_t>(model.tree.base_coordinates());
  ASSERT_EQ(undriven.size(), base + static_cast<size_t>(ir::coordinates_of(robot.joints.at("j2").type)));
  expect_generic_values(model, {}, 1000);
  if (base > 0) return;  // a weld bears no more than six
  const Eigen::VectorXd efforts = evaluate_generic(model, outputs_of(model).front(), some_state(model.tree));
  for (const int k : undriven) EXPECT_LT(std::abs(efforts[k]), 1e-6 * efforts.cwiseAbs().maxCoeff()) << k;
}

// Where a passive joint's axis goes through the point that is held, forces do nothing about it: both are what they are without
// it.
TEST(Passive, KeepsWhatNoForceBears) {
  const auto link = [](const std::string& name) {
    return "<link name='" + name +
           "'><inertial><origin xyz='0.01 0.02 0.1'/><mass value='1'/>"
           "<inertia ixx='0.02' iyy='0.021' izz='0.019' ixy='0.001' ixz='0' iyz='0'/></inertial></link>";
  };
  const auto joint = [](const std::string& name, const std::string& parent, const std::string& child, const std::string& axis) {
    return "<joint name='" + name + "' type='continuous'><parent link='" + parent + "'/><child link='" + child +
           "'/><origin xyz='0.1 0.2 0.3' rpy='0.1 0.2 0.3'/><axis xyz='" + axis + "'/></joint>";
  };
  const std::string arm = "<robot name='arm'>" + link("base") + link("a") + link("b") + link("c") +
                          joint("j1", "base", "a", "0 1 0") + joint("j2", "a", "b", "1 0 0") +
                          joint("j3", "b", "c", "0.2 1 0.3") + "</robot>";
  Diagnostics warnings;
  ir::Scene scene;
  scene.base = ir::Base::fixed;
  scene.contacts = {{"tip", "c", ir::ContactType::point, {0.02, 0.1, 0.03}, false}};  // on j3's axis
  scene.passive = {"j3"};
  scene.outputs = {ir::Quantity::inverse_dynamics, ir::Quantity::constrained_inverse_dynamics,
                   ir::Quantity::inverse_constraint_forces};
  const Model model = model_of(frontend::read_urdf_text("arm.urdf", arm, warnings), scene);
  for (unsigned seed = 1; seed < 20; ++seed) {
    State state = some_state(model.tree);
    state.q *= 0.17 * seed;
    const auto evaluated = [&](ir::Quantity quantity, reference::Precision precision) {
      return reference::evaluate(model.tree, model.scene, {{quantity, {}}}, {state.q, state.v, state.more, {}}, precision)
          .front();
    };
    for (const reference::Precision precision : {reference::Precision::float64, reference::Precision::digits_50}) {
      EXPECT_EQ(evaluated(ir::Quantity::inverse_constraint_forces, precision).cwiseAbs().maxCoeff(), 0);
      EXPECT_EQ(evaluated(ir::Quantity::constrained_inverse_dynamics, precision),
                evaluated(ir::Quantity::inverse_dynamics, precision));
    }
  }
  expect_generic_values(model, {}, 1000);
}

struct Falling {
  generic::Model<double> model;
  std::vector<QuaternionJoint> quaternion_joints;

  Eigen::VectorXd acceleration(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const {
    return generic::forward_dynamics<double>(model, q, v, Eigen::VectorXd::Zero(v.size())).value;
  }
  double energy(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const {
    const auto whole = generic::whole_robot<double>(model, q, v);
    return whole.kinetic_energy + whole.potential_energy;
  }
};

// On their groups: RK4 keeps its order and so the energy, and steps lead from one position to another.
TEST_P(JointKinds, MoveOnTheirGroups) {
  const ir::KinematicTree tree = model_of(robot.robot, scene).tree;
  Falling falling{to_generic<double>(tree, scene.gravity), {}};
  const std::vector<int> positions = tree.positions(), coordinates = tree.coordinates();
  for (size_t k = 0; k < tree.bodies.size(); ++k)
    if (tree.bodies[k].has_quaternion())
      falling.quaternion_joints.push_back(
          {tree.base_positions() + positions[k], tree.base_coordinates() + coordinates[k], tree.bodies[k].displacements() > 0});
  const State start = some_state(tree);
  const auto end = [&](int steps) {
    std::pair<Eigen::VectorXd, Eigen::VectorXd> at{start.q, start.v};
    for (int i = 0; i < steps; ++i) integrators::rk4(falling, 0.02 / steps, at.first, at.second);
    return at;
  };
  const auto coarse = end(2), middle = end(4), fine = end(8);
  const double first = (coarse.first - middle.first).norm(), second = (middle.first - fine.first).norm();
  EXPECT_GT(first, 11 * second);
  EXPECT_LT(first, 24 * second);
  const double energy = falling.energy(start.q, start.v);
  EXPECT_LT(std::abs(falling.energy(fine.first, fine.second) - energy), 1e-6 * std::abs(energy));
  Eigen::VectorXd step = start.v, there = start.q, back = start.v;
  integrators::move(start.q, step, there, falling.quaternion_joints);
  integrators::difference(start.q, there, back, falling.quaternion_joints);
  EXPECT_LT((back - step).cwiseAbs().maxCoeff(), 1e-13);
}

// Rows stand in their types' order, and say the same as their parts.
TEST(JointTypes, AreWhatTheirPartsAre) {
  ir::JointWords words = ir::urdf_joint_words();
  for (const auto& row : ir::joint_words()) words.push_back(row);
  for (const auto& [word, type] : words) {
    SCOPED_TRACE(word);
    const ir::JointTypeRow& row = ir::row_of(type);
    EXPECT_EQ(row.word, word);
    ir::Joint joint;
    joint.type = type;
    const std::vector<ir::JointPart> parts = row.parts(joint);
    const auto any = [&](bool (*moves)(ir::JointType)) {
      return std::any_of(parts.begin(), parts.end(), [&](const ir::JointPart& part) { return moves(part.type); });
    };
    EXPECT_EQ(static_cast<int>(parts.size()), row.nv);
    EXPECT_EQ(row.nq, row.nv + (row.has_quaternion() ? 1 : 0));
    EXPECT_EQ(row.turns, any(ir::turns));
    EXPECT_EQ(row.slides, any(ir::slides));
  }
  EXPECT_STREQ(ir::row_of(ir::JointType::revolute).word, ir::word_of(true, false));
  EXPECT_STREQ(ir::row_of(ir::JointType::prismatic).word, ir::word_of(false, true));
  EXPECT_STREQ(ir::row_of(ir::JointType::helical).word, ir::word_of(true, true));
}

// Directions in the plane, by the shortest turn from z: its axis has no z. Normals near −z are where that cancels.
TEST(JointTypes, PlanarDirectionsAreInThePlane) {
  for (const double aside : {0.0, 1e-12, 1e-9, 1e-7, 4e-5, 5e-5, 1e-3, 0.3, 2.0})
    for (const double down : {-1.0, 1.0})
      for (const double angle : {0.0, 0.4, 2.0, 4.0}) {
        SCOPED_TRACE(testing::Message() << aside << " " << down << " " << angle);
        ir::Joint joint;
        joint.type = ir::JointType::planar;
        joint.axis = Eigen::Vector3d(aside * std::cos(angle), aside * std::sin(angle), down).normalized();
        const std::vector<ir::JointPart> parts = ir::row_of(joint.type).parts(joint);
        const Eigen::Vector3d x = parts[0].axis, y = parts[1].axis, n = joint.axis;
        EXPECT_LT(std::abs(x.dot(n)), 3e-12);  // what is taken for −z itself
        EXPECT_LT(std::abs(y.dot(n)), 3e-12);
        EXPECT_LT((x.cross(y) - n).norm(), 3e-12);
        EXPECT_LT(std::abs(x.y() - y.x()), 1e-14);
      }
}

INSTANTIATE_TEST_SUITE_P(Kinds, JointKinds, testing::Combine(testing::ValuesIn(joint_kind_robots()), testing::Bool()),
                         [](const auto& info) {
                           return std::get<0>(info.param) + (std::get<1>(info.param) ? "_floating" : "_fixed");
                         });

}  // namespace
}  // namespace dalembert
