// From links and joints to bodies: order, fusing, locking, cutting, mimic.
#include "passes/build_tree.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <regex>
#include <robots.hpp>

#include "frontend/urdf_reader.hpp"
#include "ir/rotation.hpp"
#include "passes/combine_inertia.hpp"
#include "passes/inertia_check.hpp"
#include "passes/joints_without_mass.hpp"

namespace dalembert {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

ir::RobotDescription read(const char* file) {
  Diagnostics warnings;
  return frontend::read_urdf(file, warnings);
}

ir::KinematicTree build(const ir::RobotDescription& robot, const ir::Scene& scene) {
  Diagnostics warnings;
  return passes::build_tree(robot, scene, warnings);
}

void expect_same_bits(const ir::Inertia& a, const ir::Inertia& b) {
  EXPECT_EQ(a.mass, b.mass);
  EXPECT_EQ(a.com, b.com);
  EXPECT_EQ(a.inertia, b.inertia);
}

void expect_same_bits(const ir::KinematicTree& a, const ir::KinematicTree& b) {
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  expect_same_bits(a.base, b.base);
  for (size_t k = 0; k < a.bodies.size(); ++k) {
    SCOPED_TRACE(a.bodies[k].name);
    EXPECT_EQ(a.bodies[k].name, b.bodies[k].name);
    EXPECT_EQ(a.bodies[k].joint, b.bodies[k].joint);
    EXPECT_EQ(a.bodies[k].parent, b.bodies[k].parent);
    EXPECT_EQ(a.bodies[k].subtree_size, b.bodies[k].subtree_size);
    EXPECT_EQ(a.bodies[k].axis, b.bodies[k].axis);
    EXPECT_EQ(a.bodies[k].placement.matrix(), b.bodies[k].placement.matrix());
    expect_same_bits(a.bodies[k].inertia, b.bodies[k].inertia);
  }
}

// Spatial inertia at a frame's origin, twists linear first (Shin, Park and Park 2016, section 2).
Matrix6 spatial(const ir::Inertia& inertia) {
  const Eigen::Vector3d c = inertia.com;
  Eigen::Matrix3d cross;
  cross << 0, -c.z(), c.y(), c.z(), 0, -c.x(), -c.y(), c.x(), 0;
  Matrix6 A;
  A << inertia.mass * Eigen::Matrix3d::Identity(), -inertia.mass * cross, inertia.mass * cross,
      inertia.inertia - inertia.mass * cross * cross;
  return A;
}

class EveryRobot : public testing::TestWithParam<TestRobot> {};

TEST_P(EveryRobot, BodiesStandInDepthFirstOrder) {
  const ir::RobotDescription robot = read(GetParam().urdf);
  const ir::KinematicTree tree = build(robot, {});
  for (int k = 0; k < tree.joints(); ++k) {
    const ir::Body& body = tree.bodies[static_cast<size_t>(k)];
    EXPECT_LT(body.parent, k);
    EXPECT_NEAR(body.axis.norm(), 1, 1e-15);
    EXPECT_LE(k + body.subtree_size, tree.joints());
    for (int i = k + 1; i < tree.joints(); ++i) {  // the subtree is the range behind k
      int ancestor = i;
      while (ancestor > k) ancestor = tree.bodies[static_cast<size_t>(ancestor)].parent;
      EXPECT_EQ(ancestor == k, i < k + body.subtree_size) << k << ' ' << i;
    }
  }
  EXPECT_EQ(tree.links.size(), robot.links.size());
  const auto moving =
      std::count_if(robot.joints.begin(), robot.joints.end(), [](const auto& j) { return j.type != ir::JointType::fixed; });
  EXPECT_EQ(tree.joints(), moving);
}

TEST_P(EveryRobot, FusingKeepsTheWholeMassAndItsMoments) {
  const ir::RobotDescription robot = read(GetParam().urdf);
  const ir::KinematicTree tree = build(robot, {});
  const auto link_inertia = [&](const std::string& name) {
    return std::find_if(robot.links.begin(), robot.links.end(), [&](const auto& l) { return l.name == name; })->inertia;
  };
  for (int k = -1; k < tree.joints(); ++k) {
    Matrix6 sum = Matrix6::Zero();
    for (const ir::LinkPlacement& link : tree.links) {
      const std::optional<ir::Inertia> inertia = link_inertia(link.link);
      if (link.body != k || !inertia) continue;
      const Eigen::Matrix3d R = link.placement.linear();
      const Eigen::Vector3d p = link.placement.translation();
      Eigen::Matrix3d cross;
      cross << 0, -p.z(), p.y(), p.z(), 0, -p.x(), -p.y(), p.x(), 0;
      Matrix6 from_body;  // twist of the body at its origin → twist of the link at its own
      from_body << R.transpose(), -R.transpose() * cross, Eigen::Matrix3d::Zero(), R.transpose();
      sum += from_body.transpose() * spatial(*inertia) * from_body;
    }
    const Matrix6 fused = spatial(k < 0 ? tree.base : tree.bodies[static_cast<size_t>(k)].inertia);
    EXPECT_LE((fused - sum).cwiseAbs().maxCoeff(), 1e-14 * std::max(1.0, sum.cwiseAbs().maxCoeff())) << k;
  }
}

TEST_P(EveryRobot, LockingAtZeroIsFixingToTheLastBit) {
  const ir::RobotDescription robot = read(GetParam().urdf);
  for (size_t j = 0; j < robot.joints.size(); ++j) {
    ir::RobotDescription fixed = robot;
    ir::Scene locked;
    for (size_t i = j; i < robot.joints.size(); i += 2) {  // this one and every other behind it
      if (robot.joints[i].type == ir::JointType::fixed) continue;
      fixed.joints[i].type = ir::JointType::fixed;
      locked.locked[robot.joints[i].name] = 0;
    }
    expect_same_bits(build(robot, locked), build(fixed, {}));
    if (j > 3) break;
  }
}

TEST_P(EveryRobot, CuttingIsAUrdfWithoutTheSubtree) {
  const ir::RobotDescription robot = read(GetParam().urdf);
  for (size_t j = 0; j < std::min<size_t>(robot.joints.size(), 8); ++j) {
    ir::RobotDescription shorter = robot;
    const int parent = robot.joints[j].parent, child = robot.joints[j].child;
    std::erase(shorter.children[static_cast<size_t>(parent)], static_cast<int>(j));  // nothing leads there any more
    ir::Scene scene;
    scene.cut.insert(robot.links[static_cast<size_t>(child)].name);
    expect_same_bits(build(robot, scene), build(shorter, {}));
  }
}

INSTANTIATE_TEST_SUITE_P(BuildTree, EveryRobot, testing::ValuesIn(test_robots),
                         [](const auto& info) { return std::string(info.param.name); });

const char* two_links = R"(
<robot name="r">
  <link name="a"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="3"/></inertial></link>
  <link name="b"><inertial><origin xyz="1 2 3" rpy="0 0 1.5707963267948966"/><mass value="2"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="2.5"/></inertial></link>
  <link name="c"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="j" type="TYPE"><origin xyz="0 0 1" rpy="RPY"/><parent link="a"/><child link="b"/><axis xyz="AXIS"/></joint>
  <joint name="k" type="prismatic"><origin xyz="0 1 0"/><parent link="b"/><child link="c"/><axis xyz="0 0 2"/></joint>
</robot>)";

ir::RobotDescription two(const std::string& type, const std::string& rpy, const std::string& axis) {
  std::string text = two_links;
  for (const auto& [key, value] : {std::pair<std::string, std::string>{"TYPE", type}, {"RPY", rpy}, {"AXIS", axis}})
    text.replace(text.find(key), key.size(), value);
  Diagnostics warnings;
  return frontend::read_urdf_text("r.urdf", text, warnings);
}

TEST(BuildTree, LockingAtAValueIsAFixedJointWithThatRpy) {
  ir::Scene locked;
  locked.locked["j"] = 0.3;
  expect_same_bits(build(two("revolute", "0 0 0", "0 0 1"), locked), build(two("fixed", "0 0 0.3", "0 0 1"), {}));
  expect_same_bits(build(two("revolute", "0 0 0", "0 -1 0"), locked), build(two("fixed", "0 -0.3 0", "0 0 1"), {}));
  expect_same_bits(build(two("continuous", "0 0 0", "2 0 0"), locked), build(two("fixed", "0.3 0 0", "0 0 1"), {}));
}

TEST(BuildTree, InertiasWithRotatedOriginsAreTurnedIntoLinkAxes) {
  const ir::Inertia inertia = *two("revolute", "0 0 0", "0 0 1").links[1].inertia;
  EXPECT_EQ(inertia.com, Eigen::Vector3d(1, 2, 3));
  const Eigen::Matrix3d expected = Eigen::Vector3d(2, 1, 2.5).asDiagonal();  // a quarter turn about z swaps x and y
  EXPECT_LE((inertia.inertia - expected).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(BuildTree, AFixedBaseCarriesNothing) {
  ir::Scene scene;
  scene.base = ir::Base::fixed;
  const ir::KinematicTree tree = build(two("revolute", "0 0 0", "0 0 1"), scene);
  EXPECT_EQ(tree.base.mass, 0);
  EXPECT_EQ(tree.nq(), 2);
  EXPECT_EQ(tree.nv(), 2);
  scene.base = ir::Base::floating;
  EXPECT_EQ(build(two("revolute", "0 0 0", "0 0 1"), scene).nq(), 9);
}

TEST(BuildTree, DrivenJointsHaveNoCoordinateAndTheirExtrasAreTheirDrivers) {
  ir::Scene scene;
  scene.base = ir::Base::fixed;
  scene.mimic["k"] = {"j", -2, 0.5};
  scene.armature = {{"j", 1}, {"k", 1}};
  scene.damping = {{"k", 3}};
  scene.friction = {{"k", 3}};
  const ir::KinematicTree tree = build(two("revolute", "0 0 0", "0 0 1"), scene);
  EXPECT_EQ(tree.joints(), 2);
  EXPECT_EQ(tree.nv(), 1);
  EXPECT_EQ(tree.coordinates(), (std::vector<int>{0, 0}));
  EXPECT_TRUE(tree.bodies[1].driven());
  EXPECT_EQ(tree.bodies[1].driven_by, 0);
  EXPECT_EQ(tree.bodies[1].multiplier, -2);
  EXPECT_EQ(tree.bodies[1].offset, 0.5);
  EXPECT_EQ(tree.bodies[0].armature, 1 + 4 * 1);
  EXPECT_EQ(tree.bodies[0].damping, 4 * 3);
  EXPECT_EQ(tree.bodies[0].friction, 2 * 3);
  EXPECT_EQ(tree.bodies[1].armature, 0);
}

TEST(BuildTree, SpringsAreOfTheJointTheyAreGivenTo) {
  ir::Scene scene;
  scene.stiffness = {{"k", {3, 0.5}}};
  EXPECT_FALSE(build(two("revolute", "0 0 0", "0 0 1"), ir::Scene{}).any_spring());
  const ir::KinematicTree tree = build(two("revolute", "0 0 0", "0 0 1"), scene);
  EXPECT_TRUE(tree.any_spring());
  EXPECT_EQ(tree.bodies[0].spring.k, 0);
  EXPECT_EQ(tree.bodies[1].spring.k, 3);
  EXPECT_EQ(tree.bodies[1].spring.rest, 0.5);
}

TEST(BuildTree, AnElasticJointIsAMotorAndASpringOnTheSameAxis) {
  ir::RobotDescription robot = two("revolute", "0 0 0", "0 0 1");
  ir::Scene scene;
  const ir::KinematicTree rigid = build(robot, scene);
  scene.elastic = {{"k", {500, 3, 0.2}}};
  scene.damping = {{"k", 0.1}};
  scene.friction = {{"k", 0.7}};
  scene.stiffness = {{"k", {11, 0.5}}};
  robot.links[0].name = "k-motor";  // one name with k_motor in C++
  const ir::KinematicTree tree = build(robot, scene);
  ASSERT_EQ(tree.joints(), 3);
  const ir::Body &motor = tree.bodies[1], &link = tree.bodies[2];
  EXPECT_EQ(motor.name, "k_motor_");
  EXPECT_EQ(motor.joint, "k");
  EXPECT_EQ(motor.parent, 0);
  EXPECT_EQ(motor.placement.matrix(), rigid.bodies[1].placement.matrix());
  EXPECT_EQ(motor.inertia.mass, 0);
  EXPECT_EQ(motor.armature, 0.2);
  EXPECT_EQ(motor.damping, 0.1);
  EXPECT_EQ(motor.friction, 0.7);
  EXPECT_EQ(motor.spring.k, 11);
  EXPECT_EQ(link.name, rigid.bodies[1].name);
  EXPECT_EQ(link.joint, "k_spring");
  EXPECT_EQ(link.parent, 1);
  EXPECT_TRUE(link.placement.matrix().isIdentity(0));
  EXPECT_EQ(link.axis, motor.axis);
  expect_same_bits(link.inertia, rigid.bodies[1].inertia);
  EXPECT_EQ(link.armature, 0);
  EXPECT_EQ(link.damping, 3);
  EXPECT_EQ(link.friction, 0);
  EXPECT_EQ(link.spring.k, 500);
  EXPECT_EQ(link.spring.rest, 0);
  EXPECT_EQ(tree.links.size(), robot.links.size());
  EXPECT_EQ(tree.links.back().link, link.name);
  EXPECT_EQ(tree.links.back().body, 2);

  // A driven motor takes its inertia to the driver; the spring behind it is a coordinate of its own.
  scene.mimic = {{"k", {tree.bodies[0].joint, -2, 0.5}}};
  scene.stiffness.clear();
  const ir::KinematicTree driven = build(robot, scene);
  EXPECT_EQ(driven.independent_joints(), 2);
  EXPECT_TRUE(driven.bodies[1].driven());
  EXPECT_EQ(driven.bodies[0].armature, 4 * 0.2);

  // Where nothing hangs on the spring, locking what moves no mass makes the joint rigid again.
  scene.mimic.clear();
  robot.links[2].inertia.reset();
  Diagnostics warnings;
  const ir::KinematicTree idle = build(robot, scene);
  EXPECT_EQ(passes::joints_without_mass(idle, scene), std::vector<int>{2});
  const ir::Scene locked = passes::with_massless_locked(robot, idle, scene, warnings);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].element, "joint 'k'");
  ASSERT_EQ(build(robot, locked).joints(), 2);
  EXPECT_EQ(build(robot, locked).bodies[1].armature, 0.2);
}

TEST(JointsWithoutMass, AreThoseThatMoveNeitherMassNorInertiaNorArmature) {
  ir::RobotDescription robot = two("revolute", "0 0 0", "0 0 1");
  const auto massless = [&](const ir::Scene& scene) { return passes::joints_without_mass(build(robot, scene), scene); };
  ir::Scene scene;
  scene.base = ir::Base::fixed;
  EXPECT_EQ(massless(scene), std::vector<int>{});
  robot.links[2].inertia->mass = 0;  // a slide does not move its rotational inertia, the joint before it does
  robot.links[1].inertia.reset();
  EXPECT_EQ(massless(scene), std::vector<int>{1});
  robot.links[2].inertia.reset();
  EXPECT_EQ(massless(scene), (std::vector<int>{0, 1}));
  EXPECT_TRUE(passes::moves_no_mass(build(robot, scene), scene));  // the base's mass does not move
  scene.base = ir::Base::floating;
  EXPECT_FALSE(passes::moves_no_mass(build(robot, scene), scene));
  scene.payloads = {"b"};
  EXPECT_EQ(massless(scene), std::vector<int>{1});
  scene.armature = {{"k", 0.1}};
  EXPECT_EQ(massless(scene), std::vector<int>{});
  scene.armature = {};
  scene.mimic["k"] = {"j", 1, 0.5};
  EXPECT_EQ(massless(scene), std::vector<int>{});  // k has no coordinate
  scene.payloads = {};
  EXPECT_EQ(massless(scene), std::vector<int>{0});
  Diagnostics warnings;
  const ir::Scene locked = passes::with_massless_locked(robot, build(robot, scene), scene, warnings);
  EXPECT_EQ(locked.locked, (std::map<std::string, double>{{"j", 0}, {"k", 0.5}}));
  EXPECT_TRUE(locked.mimic.empty());
}

TEST(Rotation, ZerosAndOnesAreExact) {
  EXPECT_EQ(ir::rotation_from_rpy({0, 0, 0}), Eigen::Matrix3d::Identity());
  const Eigen::Matrix3d yaw_roll = ir::rotation_from_rpy({0.3, 0, 0.7});
  EXPECT_EQ(yaw_roll(2, 0), 0);  // a quaternion would leave 1e-17 here
  EXPECT_FALSE(std::signbit(yaw_roll(2, 0)));
  EXPECT_EQ(ir::rotation_about({0, 0, 1}, 0.4), ir::rotation_from_rpy({0, 0, 0.4}));
  EXPECT_NE(ir::rotation_from_rpy({-1.5708, 0, 0})(1, 1), 0);  // not snapped
  const Eigen::Vector3d skew = Eigen::Vector3d(1, -2, 0.5).normalized();
  EXPECT_LE((ir::rotation_about(skew, 2.2) - Eigen::AngleAxisd(2.2, skew).toRotationMatrix()).norm(), 1e-15);
  const Eigen::Vector3d nearly_z(1e-8, 0, 1);  // of length 1 but for rounding
  EXPECT_LE((ir::rotation_about(nearly_z, 3) - Eigen::AngleAxisd(3, nearly_z).toRotationMatrix()).norm(), 1e-15);
}

TEST(Rotation, SquareTurnsAreExactAndOthersUntouched) {
  constexpr double right_angle = 1.5707963267948966;
  Eigen::Matrix3d quarter;
  quarter << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  EXPECT_NE(ir::rotation_from_rpy({right_angle, 0, 0}), quarter);
  EXPECT_EQ(ir::without_rounding_dust(ir::rotation_from_rpy({right_angle, 0, 0})), quarter);
  const Eigen::Matrix3d nearly = ir::rotation_from_rpy({-1.5708, 1e-9, 0});
  EXPECT_EQ(ir::without_rounding_dust(nearly), nearly);
}

TEST(CombineInertia, OnePartAndPartsWithoutMassChangeNoBit) {
  const ir::Inertia part{0.3, {0.1, 0.7, -0.3}, Eigen::Vector3d(0.1, 0.2, 0.3).asDiagonal()};
  expect_same_bits(passes::combined({part}), part);
  expect_same_bits(passes::combined({part, ir::Inertia{}}), part);
  expect_same_bits(passes::moved(part, Eigen::Isometry3d::Identity()), part);
}

// Of all matrices without negative second moments the repaired one is the nearest: no step from it toward the given one, nor
// any other small step, stays among them and comes nearer.
TEST(InertiaCheck, RepairsToTheNearestBody) {
  Eigen::Matrix3d given;
  given << 1, 0.3, -0.2, 0.3, 0.4, 0.1, -0.2, 0.1, 2.5;
  ir::RobotDescription robot;
  robot.links = {{"a", ir::Inertia{2, {0.1, 0.2, 0.3}, given}}};
  robot.root = 0;
  robot.children.resize(1);
  ir::Scene scene;
  scene.inertia = ir::InertiaPolicy::repair;
  ir::KinematicTree tree = build(robot, scene);
  Diagnostics warnings;
  passes::check_inertias(robot, scene, tree, warnings);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(tree.base.mass, 2);
  EXPECT_EQ(tree.base.com, Eigen::Vector3d(0.1, 0.2, 0.3));
  const auto second = [](const Eigen::Matrix3d& inertia) -> Eigen::Matrix3d {
    return 0.5 * inertia.trace() * Eigen::Matrix3d::Identity() - inertia;
  };
  const auto least = [&](const Eigen::Matrix3d& s) {
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(s, Eigen::EigenvaluesOnly).eigenvalues()[0];
  };
  const Eigen::Matrix3d before = second(given), after = second(tree.base.inertia);
  EXPECT_LT(least(before), -0.1);
  EXPECT_NEAR(least(after), 0, 1e-14);
  std::srand(7);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Matrix3d root = Eigen::Matrix3d::Random();
    const Eigen::Matrix3d other = 0.99 * after + 0.01 * root * root.transpose();  // some other body's
    EXPECT_GE((other - before).norm(), (after - before).norm() - 1e-15);
  }
  warnings.clear();
  passes::check_inertias(robot, scene, tree, warnings);  // and once it is one, it stays
  EXPECT_TRUE(warnings.empty());
}

TEST(InertiaCheck, ToleratesRoundingRelativeToTheBodyAndToTheRobot) {
  const auto outcome = [](double moment, double others, double robot_s, ir::Base base = ir::Base::floating) {
    ir::RobotDescription robot;
    for (const double m : {others, robot_s})
      robot.links.push_back(
          {robot.links.empty() ? "a" : "b", ir::Inertia{1, {0, 0, 0}, Eigen::Vector3d(m, m, m).asDiagonal()}});
    robot.links[0].inertia->inertia(2, 2) = moment;
    robot.root = 0;
    robot.children = {{0}, {}};
    ir::Joint joint;
    joint.type = ir::JointType::revolute;
    joint.parent = 0;
    joint.child = 1;
    robot.joints = {joint};
    ir::Scene scene;
    scene.base = base;
    ir::KinematicTree tree = build(robot, scene);
    Diagnostics warnings;
    try {
      passes::check_inertias(robot, scene, tree, warnings);
    } catch (const InputError&) {
      return std::string("refused");
    }
    return std::string(warnings.empty() ? "silent" : "warned");
  };
  EXPECT_EQ(outcome(-2e-6, 1, 1), "warned");
  EXPECT_EQ(outcome(-2e-5, 1, 1), "refused");
  EXPECT_EQ(outcome(-1.8e-22, 1e-22, 0.1), "warned");  // negligible in the robot
  EXPECT_EQ(outcome(-1.8e-22, 1e-22, 1e-15), "refused");
  EXPECT_EQ(outcome(-6e-8, 1e-7, 0.5), "refused");
  EXPECT_EQ(outcome(-1e-14, 1, 1), "silent");
  EXPECT_EQ(outcome(-1, 1, 1, ir::Base::fixed), "silent");  // it does not move
}

// Whatever is drawn, it is judged as if its links were one, wherever the joints between them stand: the sum of sound links is
// sound, and a negative moment of one link counts by what it leaves of the sum.
TEST(InertiaCheck, LinksWeldedTogetherCountAsOne) {
  const auto outcome = [](double moment, double mass, double distance) {
    ir::RobotDescription robot;
    robot.links.push_back({"a", ir::Inertia{1, {0, 0, 0}, Eigen::Vector3d(1, 1, 1).asDiagonal()}});
    robot.links.push_back({"b", ir::Inertia{mass, {0, 0, 0}, Eigen::Vector3d(moment, 1, 1).asDiagonal()}});
    robot.root = 0;
    robot.children = {{0}, {}};
    ir::Joint weld;
    weld.parent = 0;
    weld.child = 1;
    weld.origin.translation() = Eigen::Vector3d(0, 0, distance);
    robot.joints = {weld};
    const ir::Scene scene;
    ir::KinematicTree tree = build(robot, scene);
    Diagnostics warnings;
    try {
      passes::check_inertias(robot, scene, tree, warnings);
    } catch (const InputError& error) {
      return error.diagnostics().front().element + " refused";
    }
    return warnings.empty() ? "silent" : warnings.front().element + " warned";
  };
  EXPECT_EQ(outcome(1, 1, 0.3), "silent");
  EXPECT_EQ(outcome(-0.99, 1, 0), "link 'b' (line 0) warned");
  EXPECT_EQ(outcome(-1.01, 1, 0), "body 'a' refused");
  EXPECT_EQ(outcome(-1 - 1e-6, 1, 0), "body 'a' warned");        // by rounding
  EXPECT_EQ(outcome(-1.01, 1, 0.2), "body 'a' warned");          // Steiner's 0.5 kg (0.2 m)² leave the triangle inequality
  EXPECT_EQ(outcome(1.5, -0.2, 1), "link 'b' (line 0) warned");  // 2.5, 2, 2 kg m² less 0.2/0.8 kg (1 m)² about x and y
  EXPECT_EQ(outcome(1.5, -0.7, 1), "body 'a' refused");
  EXPECT_EQ(outcome(1.5, -1.1, 0), "body 'a' refused");
}

TEST(BuildTree, LongChainsTakeLinearTimeAndNoStack) {
  std::string text = "<robot name='r'><link name='l0'/>";
  const int links = 5000;
  for (int i = 1; i < links; ++i) {
    const std::string n = std::to_string(i);
    text += "<link name='l" + n +
            "'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>";
    text += "<joint name='j" + n + "' type='revolute'><parent link='l" + std::to_string(i - 1) + "'/><child link='l" + n +
            "'/><axis xyz='0 0 1'/></joint>";
  }
  Diagnostics warnings;
  const ir::RobotDescription robot = frontend::read_urdf_text("r.urdf", text + "</robot>", warnings);
  ir::Scene scene;
  scene.base = ir::Base::fixed;
  const ir::KinematicTree tree = build(robot, scene);
  EXPECT_EQ(tree.joints(), links - 1);
  EXPECT_EQ(tree.bodies.front().subtree_size, links - 1);
}

// Each number alone can be written; sums and products of them cannot.
TEST(BuildTree, NumbersTooLargeToComputeWithAreRefused) {
  const auto refusal = [](const std::string& mass, const std::string& xyz, const ir::Scene& scene) -> std::string {
    std::string text = "<robot name='r'>";
    for (const char* link : {"a", "b", "c"})
      text += "<link name='" + std::string(link) + "'><inertial><mass value='" + mass +
              "'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>";
    text += "<joint name='j' type='continuous'><origin xyz='" + xyz +
            "'/><parent link='a'/><child link='b'/><axis xyz='0 0 1'/></joint>"
            "<joint name='k' type='fixed'><parent link='b'/><child link='c'/></joint></robot>";
    Diagnostics warnings;
    try {
      passes::build_tree(frontend::read_urdf_text("r.urdf", text, warnings), scene, warnings);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  const std::string message =
      ": error: a length, mass or other number is larger than 1e+60; check the numbers of the URDF and the scene: lengths are "
      "m, masses kg";
  EXPECT_EQ(refusal("1e59", "1e59 0 0", {}), "");
  EXPECT_EQ(refusal("6e59", "0 0 0", {}), "r.urdf: joint 'j' and link 'b'" + message);
  EXPECT_EQ(refusal("1e308", "0 0 0", {}), "r.urdf: link 'a'" + message + "\nr.urdf: joint 'j' and link 'b'" + message);
  EXPECT_EQ(refusal("1", "1e300 0 0", {}), "r.urdf: joint 'j' and link 'b'" + message);
  ir::Scene scene;
  scene.armature["j"] = 1e100;
  EXPECT_EQ(refusal("1", "0 0 0", scene), "r.urdf: joint 'j' and link 'b'" + message);
  scene = {};
  scene.gravity.x() = 1e61;
  EXPECT_EQ(refusal("1", "0 0 0", scene), "scene key 'gravity'" + message);
  // A file's own loops and screws, which no scene's text has.
  scene = {};
  scene.loops.push_back({.name = "rod", .links = {"a", "b"}});
  scene.loops.front().at[1].translation().y() = 1e61;
  EXPECT_EQ(refusal("1", "0 0 0", scene), "r.urdf: loop 'rod'" + message);
  scene = {};
  scene.joints["j"] = {.type = ir::JointType::helical, .pitch = -1e61};
  EXPECT_EQ(refusal("1", "0 0 0", scene), "r.urdf: joint 'j' and link 'b'" + message);

  scene = {};
  scene.scalar = ir::ScalarType::float32;
  EXPECT_EQ(refusal("1e11", "1e12 0 0", scene), "");
  const std::string in_float = std::regex_replace(message, std::regex("1e\\+60"), "1e+12, too large for float");
  EXPECT_EQ(refusal("1", "1e13 0 0", scene), "r.urdf: joint 'j' and link 'b'" + in_float);
  scene.gravity.z() = -2e12;
  EXPECT_EQ(refusal("1", "0 0 0", scene), "scene key 'gravity'" + in_float);
}

}  // namespace
}  // namespace dalembert
