// Elastic joints: what the robot with a motor and a spring in a joint has to do with the rigid one.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <robots.hpp>

#include "commands/info.hpp"
#include "frontend/urdf_reader.hpp"
#include "passes/build_tree.hpp"
#include "read_robot.hpp"
#include "reference/engine.hpp"

namespace dalembert {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;
using ir::Quantity;

ir::KinematicTree build(const ir::RobotDescription& robot, const ir::Scene& scene) {
  Diagnostics warnings;
  return passes::build_tree(robot, scene, warnings);
}

MatrixXd value(Quantity quantity, const ir::KinematicTree& tree, const ir::Scene& scene, const reference::Inputs& inputs) {
  return reference::evaluate(tree, scene, {{quantity, "", {}}}, inputs, reference::Precision::float64)[0];
}

void expect_near(const MatrixXd& a, const MatrixXd& b, double tolerance) {
  ASSERT_EQ(a.rows(), b.rows());
  ASSERT_EQ(a.cols(), b.cols());
  EXPECT_LE((a - b).cwiseAbs().maxCoeff<Eigen::PropagateNaN>(), tolerance * std::max(b.cwiseAbs().maxCoeff(), 1e-3));
}

class ElasticJoints : public testing::TestWithParam<TestRobot> {};

// A link stands where motor and spring together take it. So with v_rigid = T v, every matrix of the rigid robot becomes
// T' (...) T, and motors and springs stand on diagonals beside it.
TEST_P(ElasticJoints, AreTheRigidOnesInMoreCoordinates) {
  Diagnostics warnings;
  const ir::RobotDescription robot = frontend::read_urdf(GetParam().urdf, warnings);
  for (const ir::Base base : {ir::Base::fixed, ir::Base::floating}) {
    ir::Scene scene;
    scene.base = base;
    scene.gravity = {0.7, -1.3, -9.81};
    const ir::KinematicTree rigid = build(robot, scene);
    ir::Scene elastic_scene = scene;
    for (size_t k = 0; k < rigid.bodies.size(); k += 3) elastic_scene.elastic[rigid.bodies[k].joint] = {120, 0.6, 0.4};
    const ir::KinematicTree elastic = build(robot, elastic_scene);

    const int first = elastic.nv() - elastic.joints(), head = elastic.nq() - elastic.joints();
    MatrixXd to_rigid = MatrixXd::Zero(rigid.nv(), elastic.nv());
    VectorXd motors = VectorXd::Zero(elastic.nv()), springs = motors, dampers = motors;
    to_rigid.topLeftCorner(first, first).setIdentity();
    for (int k = 0, j = -1; k < elastic.joints(); ++k) {
      const ir::Body& body = elastic.bodies[static_cast<size_t>(k)];
      to_rigid(first + (body.elastic.empty() ? ++j : j), first + k) = 1;
      motors[first + k] = body.armature;
      springs[first + k] = body.spring.k;
      dampers[first + k] = body.damping;
    }
    EXPECT_EQ(elastic.joints(), rigid.joints() + static_cast<int>(elastic_scene.elastic.size()));

    reference::Inputs at;
    at.q = VectorXd(elastic.nq()), at.v = VectorXd(elastic.nv()), at.more = VectorXd(elastic.nv());
    for (int i = 0; i < elastic.nq(); ++i) at.q[i] = std::sin(1 + 1.7 * i);
    for (int i = 0; i < elastic.nv(); ++i) at.v[i] = std::cos(2 + 1.3 * i), at.more[i] = std::cos(1 + 1.9 * i);
    if (elastic.base_coordinates() > 0) at.q.segment<4>(3).normalize();
    reference::Inputs rigid_at{VectorXd(rigid.nq()), to_rigid * at.v, to_rigid * at.more};
    rigid_at.q << at.q.head(head), to_rigid.bottomRightCorner(rigid.joints(), elastic.joints()) * at.q.tail(elastic.joints());

    for (const Quantity quantity : {Quantity::mass_matrix, Quantity::coriolis_matrix}) {
      MatrixXd expected = to_rigid.transpose() * value(quantity, rigid, scene, rigid_at) * to_rigid;
      if (quantity == Quantity::mass_matrix) expected.diagonal() += motors;
      expect_near(value(quantity, elastic, elastic_scene, at), expected, 1e-12);
    }
    const VectorXd efforts = value(Quantity::inverse_dynamics, elastic, elastic_scene, at);
    VectorXd strained = VectorXd::Zero(elastic.nv());
    strained.tail(elastic.joints()) = springs.tail(elastic.joints()).cwiseProduct(at.q.tail(elastic.joints()));
    expect_near(efforts,
                to_rigid.transpose() * value(Quantity::inverse_dynamics, rigid, scene, rigid_at) + strained +
                    dampers.cwiseProduct(at.v) + motors.cwiseProduct(at.more),
                1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, ElasticJoints, testing::ValuesIn(test_robots),
                         [](const auto& info) { return std::string(info.param.name); });

// A motor B, a spring k with a damper d, and a pendulum J about the joint, in closed form.
TEST(ElasticPendulum, MovesAsTwoInertiasOnASpring) {
  constexpr double J = 0.4 + 2 * 0.3 * 0.3, B = 0.03, k = 700, d = 1.5;
  Diagnostics warnings;
  const ir::RobotDescription robot = frontend::read_urdf_text("r.urdf",
                                                              R"(<robot name="r"><link name="world"/>
<link name="arm"><inertial><origin xyz="0.3 0 0"/><mass value="2"/>
  <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="0.4"/></inertial></link>
<joint name="j" type="continuous"><parent link="world"/><child link="arm"/><axis xyz="0 0 1"/></joint></robot>)",
                                                              warnings);
  ir::Scene scene;
  scene.base = ir::Base::fixed;
  scene.gravity.setZero();
  scene.elastic = {{"j", {k, d, B}}};
  const ir::KinematicTree tree = build(robot, scene);
  const double deflection = 0.02, rate = -0.3, torque = 5;
  const reference::Inputs at{Eigen::Vector2d(1.1, deflection), Eigen::Vector2d(0.7, rate), Eigen::Vector2d(torque, 0)};
  const VectorXd acceleration = value(Quantity::forward_dynamics, tree, scene, at);
  const double spring = k * deflection + d * rate;  // pushes the motor on and holds the link back
  EXPECT_NEAR(acceleration[0], (torque + spring) / B, 1e-11);
  EXPECT_NEAR(acceleration.sum(), -spring / J, 1e-11);
  EXPECT_NEAR(value(Quantity::potential_energy, tree, scene, at)(0, 0), k * deflection * deflection / 2, 1e-15);
}

TEST(ElasticJoint, IsShownByInfoWithMotorAndSpring) {
  const std::string text =
      describe(read_robot("two_branches_at_base",
                          {{"elastic", "{a_02_joint: {k: 500, inertia: 0.2, damping: 3}}"}, {"friction", "a_02_joint=0.5"}}));
  EXPECT_NE(text.find(" -> a_02_joint_motor, 0 kg, armature 0.2, friction 0.5\n"), text.npos) << text;
  EXPECT_NE(text.find(" kg, damping 3, spring 500 at rest at 0\n"), text.npos) << text;
  EXPECT_NE(text.find("a_02_joint_spring: revolute"), text.npos) << text;
}

}  // namespace
}  // namespace dalembert
