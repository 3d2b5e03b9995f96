// Poses, twists, Jacobians and bias accelerations of links in a hundred digits, against differences of poses placed one by one.
#include <gtest/gtest.h>

#include <dalembert/generic/frames.hpp>

#include "identities.hpp"
#include "load_robot.hpp"
#include "scale.hpp"
#include "states.hpp"

namespace dalembert::testing {
namespace {

using generic::Axes;

constexpr double tolerance = 1e-25;
const Multi step("1e-30");

Vector3<Multi> unskew(const Matrix3<Multi>& m) { return {m(2, 1), m(0, 2), m(1, 0)}; }

using RobotAndBase = std::tuple<TestRobot, bool>;

class Frames : public ::testing::TestWithParam<RobotAndBase> {
 protected:
  Frames() {
    const auto [robot, floating] = GetParam();
    const ir::KinematicTree tree = load_robot(robot, floating);
    const State state = moderate_state(tree, 1);
    c = {exact_model(tree, test_gravity), exact_position(tree, state.q), state.v.cast<Multi>()};
    frame.rotation = rotation_about<Multi>(Vector3<Multi>(1, 2, -2) / 3, Multi("0.7"));
    frame.translation = {Multi("0.1"), Multi("-0.2"), Multi("0.3")};
    bodies = {c.model.joints() - 1, c.model.joints() / 2};
    if (floating) bodies.push_back(-1);
  }

  generic::Kinematics<Multi> kinematics(const Vector& q) const { return generic::phase1<Multi>(c.model, q, c.v); }
  Transform<Multi> pose(const Vector& q, int body) const {
    return world_poses(c.model, q)[static_cast<size_t>(body + 1)] * frame;
  }
  // The frame's velocity by differences of its pose.
  Vector twist(const Vector& q, int body, Axes axes) const {
    const Transform<Multi> before = pose(integrate(c.model, q, c.v, -step), body),
                           after = pose(integrate(c.model, q, c.v, step), body), now = pose(q, body);
    const Matrix3<Multi> spin = (after.rotation - before.rotation) / (2 * step) * now.rotation.transpose();
    Vector3<Multi> linear = (after.translation - before.translation) / (2 * step), angular = unskew(spin);
    if (axes == Axes::world) linear += now.translation.cross(angular);
    Vector result(6);
    result << linear, angular;
    if (axes == Axes::body) {
      result.head<3>() = (now.rotation.transpose() * result.head<3>()).eval();
      result.tail<3>() = (now.rotation.transpose() * result.tail<3>()).eval();
    }
    return result;
  }
  Vector by_jacobian(const Vector& q, int body, Axes axes) const {
    return generic::expanded_frame_jacobian<Multi>(c.model, kinematics(q), q, body, frame, axes) * c.v;
  }
  static double error(const Matrix& a, const Matrix& b) { return relative_error(a, b, std::max<Multi>(largest(b), 1)); }

  Case c;
  Transform<Multi> frame;
  std::vector<int> bodies;
};

TEST_P(Frames, StandAndMoveAsTheirPosesDo) {
  for (const int body : bodies) {
    const Transform<Multi> here = generic::frame_pose<Multi>(c.model, kinematics(c.q), c.q, body, frame),
                           expected = pose(c.q, body);
    EXPECT_LE(error(here.rotation, expected.rotation), tolerance);
    EXPECT_LE(error(here.translation, expected.translation), tolerance);
    EXPECT_LE(error(generic::frame_twist<Multi>(kinematics(c.q), body, frame), twist(c.q, body, Axes::body)), tolerance);
    for (const Axes axes : {Axes::body, Axes::world, Axes::mixed})
      EXPECT_LE(error(by_jacobian(c.q, body, axes), twist(c.q, body, axes)), tolerance);
  }
}

// With constant v the rate of J v is dJ/dt v.
TEST_P(Frames, BiasAccelerationIsTheRateOfTheJacobianTimesV) {
  for (const int body : bodies)
    for (const Axes axes : {Axes::body, Axes::world, Axes::mixed}) {
      const Vector rate = (by_jacobian(integrate(c.model, c.q, c.v, step), body, axes) -
                           by_jacobian(integrate(c.model, c.q, c.v, -step), body, axes)) /
                          (2 * step);
      EXPECT_LE(error(generic::frame_acceleration_bias<Multi>(c.model, kinematics(c.q), c.q, c.v, body, frame, axes), rate),
                tolerance)
          << "body " << body << ", axes " << static_cast<int>(axes);
    }
}

INSTANTIATE_TEST_SUITE_P(Robots, Frames, ::testing::Combine(::testing::ValuesIn(test_robots), ::testing::Bool()),
                         [](const auto& info) {
                           return std::string(std::get<0>(info.param).name) +
                                  (std::get<1>(info.param) ? "_floating" : "_fixed");
                         });

}  // namespace
}  // namespace dalembert::testing
