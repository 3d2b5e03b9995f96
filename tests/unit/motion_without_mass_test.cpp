// Which robots have a singular M wherever they stand, and which are only light.
#include "reference/motion_without_mass.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>
#include <read_robot.hpp>

#include "ir/rotation.hpp"
#include "passes/build_tree.hpp"
#include "passes/joints_without_mass.hpp"
#include "reference/eigenvalues.hpp"
#include "reference/engine.hpp"

namespace dalembert {
namespace {

using Eigen::Vector3d;

const ir::Inertia full{1.3, {0.02, 0.05, -0.1}, Vector3d(0.1, 0.2, 0.25).asDiagonal()};
const ir::Inertia point{0.7, {0.1, -0.2, 0.15}, Eigen::Matrix3d::Zero()};

ir::KinematicTree robot(bool floating, const ir::Inertia& base) {
  ir::KinematicTree tree;
  tree.base_link = "base";
  if (floating) tree.base_joint = ir::JointType::floating;
  tree.base = base;
  tree.links = {{"base", -1}};
  return tree;
}

ir::Body& add(ir::KinematicTree& tree, int parent, const Vector3d& axis, const Vector3d& at, const ir::Inertia& inertia) {
  ir::Body body;
  body.name = "l" + std::to_string(tree.bodies.size());
  body.joint = "j" + std::to_string(tree.bodies.size());
  body.parent = parent;
  body.axis = axis.normalized();
  body.placement.translation() = at;
  body.inertia = inertia;
  tree.links.push_back({body.name, tree.joints()});
  tree.bodies.push_back(body);
  return tree.bodies.back();
}

// Who takes part: "base 0 2", or "none".
std::string found(const ir::KinematicTree& tree, const ir::Scene& scene = {}) {
  const auto motion = reference::motion_without_mass(tree, scene);
  if (!motion) return "none";
  std::string text = motion->base ? "base" : "";
  for (const int k : motion->bodies) text += (text.empty() ? "" : " ") + std::to_string(k);
  return text;
}

TEST(MotionWithoutMass, ABaseWithoutMassTurnsAsItsOnlyJointTurnsBack) {
  for (const Vector3d& at : {Vector3d(0, 0, 0), Vector3d(0.1, 0.2, -0.3)}) {
    ir::KinematicTree tree = robot(true, {});
    add(tree, -1, {0, 0, 1}, at, full).placement.linear() = ir::rotation_from_rpy({0.3, -0.5, 1});
    add(tree, 0, {1, 2, 3}, {0.1, 0.2, 0.3}, full);
    EXPECT_EQ(found(tree), "base 0");
    tree.bodies[0].type = ir::JointType::prismatic;
    EXPECT_EQ(found(tree), "base 0");
    tree.bodies[0].armature = 1e-9;
    EXPECT_EQ(found(tree), "none");
    tree.bodies[0].armature = 0;
    ir::Scene scene;
    scene.payloads = {"base"};
    EXPECT_EQ(found(tree, scene), "none");
    tree.base_joint = ir::JointType::fixed;
    EXPECT_EQ(found(tree), "none");
    tree.base_joint = ir::JointType::floating;
    add(tree, -1, {0, 1, 0}, {0, 0.4, 0}, full);  // two joints hold it
    EXPECT_EQ(found(tree), "none");
  }
}

TEST(MotionWithoutMass, LightPartsMoveAMass) {
  for (const double light : {1e-6, 1e-12, 1e-18, 1e-24}) {
    ir::KinematicTree tree = robot(true, {light, {0.01, 0, 0}, light * 1e-6 * Eigen::Matrix3d::Identity()});
    add(tree, -1, {0, 0, 1}, {0, 0, 0.3}, full).placement.linear() = ir::rotation_from_rpy({0.3, -0.5, 1});
    add(tree, 0, {1, 2, 3}, {0.1, 0.2, 0.3}, full);
    EXPECT_EQ(found(tree), "none") << light;
  }
}

TEST(MotionWithoutMass, AxesThatCoincideToRoundingAreOne) {
  const auto tree_of = [](double tilt) {
    ir::KinematicTree tree = robot(false, {});
    add(tree, -1, {0.2, 0.5, -0.7}, {0, 0.1, 0.2}, full);
    add(tree, 0, {0.1, 0.7, 0.3}, {0.3, 0.1, -0.2}, {});
    const Eigen::Matrix3d turned = ir::rotation_from_rpy({0.3, -0.5, 1.1});
    const Vector3d axis = turned.transpose() * (Vector3d(0.1, 0.7, 0.3).normalized() + tilt * Vector3d(0.7, 0.1, 0));
    add(tree, 1, axis, 0.4 * Vector3d(0.1, 0.7, 0.3).normalized(), full).placement.linear() = turned;
    return tree;
  };
  EXPECT_EQ(found(tree_of(0)), "1 2");
  for (const double tilt : {1e-3, 1e-6, 1e-9, 1e-12}) EXPECT_EQ(found(tree_of(tilt)), "none") << tilt;
}

TEST(MotionWithoutMass, ABarWithoutThicknessTurnsAboutItself) {
  const Eigen::Matrix3d turned = ir::rotation_from_rpy({0.3, -0.5, 1.1});
  ir::KinematicTree tree = robot(false, {});
  add(tree, -1, {0, 1, 0}, {0, 0, 0}, full);
  add(tree, 0, turned.col(2), {0, 0, 0.5}, {2, 0.3 * turned.col(2), ir::rotated(Vector3d(0.1, 0.1, 0).asDiagonal(), turned)});
  EXPECT_EQ(found(tree), "1");
  tree.bodies[1].inertia.inertia = ir::rotated(Vector3d(0.1, 0.1, 1e-12).asDiagonal(), turned);
  EXPECT_EQ(found(tree), "none");
}

TEST(MotionWithoutMass, APointMassIsMovedByNoMoreThanThreeJoints) {
  for (const double moment : {0.0, 1e-14}) {
    ir::KinematicTree tree = robot(false, {});
    for (int k = 0; k < 4; ++k) add(tree, k - 1, Vector3d::Unit(k % 3) + Vector3d(0.1, 0.2, 0.1), {0.3, 0.2, 0.1}, {});
    tree.bodies.back().inertia = {1, {0.3, 0.1, 0.2}, moment * Eigen::Matrix3d::Identity()};
    EXPECT_EQ(found(tree), moment == 0 ? "0 1 2 3" : "none");
  }
  EXPECT_EQ(found(robot(true, point)), "base");
  EXPECT_EQ(found(robot(true, full)), "none");
}

TEST(MotionWithoutMass, ADrivenJointNeedsNoMassOfItsOwn) {
  ir::KinematicTree tree = robot(false, {});
  add(tree, -1, {0, 0, 1}, {0, 0, 0}, full);
  add(tree, 0, {0, 0, 1}, {0.1, 0, 0}, {});
  EXPECT_EQ(found(tree), "1");
  tree.bodies[1].driven_by = 0;
  tree.bodies[1].multiplier = -2;
  EXPECT_EQ(found(tree), "none");
  tree = robot(true, {});
  add(tree, -1, {0, 0, 1}, {0, 0, 0}, full);
  add(tree, 0, {0, 0, 1}, {0.1, 0, 0}, full).driven_by = 0;  // it cannot stay when the first turns back
  EXPECT_EQ(found(tree), "none");
}

// No test robot is refused.
TEST(MotionWithoutMass, IsNotFoundWhereThereIsNone) {
  for (const TestRobot& robot : test_robots)
    for (const char* base : {"fixed", "floating"}) {
      const Model model = read_robot(robot.name, {{"base", base}});
      if (!passes::joints_without_mass(model.tree, model.scene).empty()) continue;
      EXPECT_EQ(found(model.tree, model.scene), "none") << robot.name << " " << base;
    }
}

// Small robots of full, flat, thin, point-like and missing bodies on axes along coordinates or not: singular are those whose M
// has an eigenvalue of rounding's size (its rows and columns scaled to a diagonal of 1) at each of five states.
TEST(MotionWithoutMass, AgreesWithTheEigenvaluesOfM) {
  std::mt19937 engine(7);
  const auto uniform = [&] { return std::uniform_real_distribution<>(-1, 1)(engine); };
  const auto one_of = [&](int n) { return std::uniform_int_distribution<>(0, n - 1)(engine); };
  int singular = 0, sound = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto inertia = [&]() -> ir::Inertia {
      const Vector3d com = one_of(2) ? Vector3d(uniform(), uniform(), uniform()) : Vector3d(0, 0, uniform());
      switch (one_of(6)) {
        case 0: return {};
        case 1: return {1, com, Eigen::Matrix3d::Zero()};
        case 2: return {1, com, Vector3d(0.5, 0.5, 0).asDiagonal()};
        case 3: return {0, Vector3d::Zero(), Vector3d(0.5, 0.5, 1).asDiagonal()};
        default: return {1, com, Vector3d(0.5, 0.7, 0.9).asDiagonal()};
      }
    };
    ir::KinematicTree tree = robot(one_of(2), inertia());
    for (int k = 0, n = 1 + one_of(4); k < n; ++k) {
      const Vector3d axis = one_of(2) ? Vector3d(uniform(), uniform(), uniform()) : Vector3d::Unit(one_of(3));
      const Vector3d place = one_of(2) ? Vector3d(uniform(), uniform(), uniform()) : Vector3d(0, 0, 0.5 * one_of(2));
      ir::Body& body = add(tree, one_of(3) ? k - 1 : one_of(k + 1) - 1, axis, place, inertia());
      if (one_of(2)) body.placement.linear() = ir::rotation_from_rpy({uniform(), uniform(), uniform()});
      if (!one_of(4)) body.type = ir::JointType::prismatic;
      if (!one_of(6)) body.armature = 0.1;
    }
    const ir::Scene scene;
    if (!passes::joints_without_mass(tree, scene).empty()) continue;
    double best = 0;
    for (int state = 0; state < 5; ++state) {
      reference::Inputs inputs{Eigen::VectorXd(tree.nq()), Eigen::VectorXd::Zero(tree.nv())};
      for (double& q : inputs.q) q = uniform();
      if (tree.base_coordinates() > 0) inputs.q.segment<4>(3).normalize();
      Eigen::MatrixXd M =
          reference::evaluate(tree, scene, {{ir::Quantity::mass_matrix, {}}}, inputs, reference::Precision::extended).front();
      const Eigen::VectorXd scale = M.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
      M = (scale.asDiagonal() * M * scale.asDiagonal()).eval();
      best = std::max(best, reference::eigenvalues(M)[0]);
    }
    ASSERT_FALSE(best > 1e-14 && best < 1e-9) << best;  // neither, and the draw is to be changed
    EXPECT_EQ(found(tree) == "none", best > 1e-9) << i << ": " << found(tree) << ", " << best;
    ++(best > 1e-9 ? sound : singular);
  }
  EXPECT_GT(singular, 200);
  EXPECT_GT(sound, 200);
}

}  // namespace
}  // namespace dalembert
