// Poses move on their group, and nothing of a step is allocated.
#define EIGEN_RUNTIME_NO_MALLOC
#include <stdexcept>
#define eigen_assert(condition) \
  if (!(condition)) throw std::logic_error(#condition)

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <unsupported/Eigen/MatrixFunctions>

#include "systems.hpp"

namespace dalembert::testing {
namespace {

using Q = Eigen::Matrix<double, 9, 1>;  // a base and two joints
using V = Eigen::Matrix<double, 8, 1>;

Eigen::Matrix4d pose(const Q& q) {
  Eigen::Matrix4d result = Eigen::Matrix4d::Identity();
  result.topLeftCorner<3, 3>() = Eigen::Quaterniond(q[6], q[3], q[4], q[5]).toRotationMatrix();
  result.topRightCorner<3, 1>() = q.head<3>();
  return result;
}

Q some_pose() {
  Q q;
  q << 0.3, -0.2, 0.9, 0.5, -0.1, 0.7, 0.2, 1.5, -0.5;
  q.segment<4>(3).normalize();
  return q;
}

TEST(Move, IsTheMatrixExponential) {
  for (double size : {0.0, 1e-9, 1e-4, 0.02, 0.04, 1.0, 3.0, 7.0}) {
    V step;
    step << 0.5, -0.3, 0.8, 0.4, 0.6, -0.7, 0.1, 0.2;
    step *= size;
    Eigen::Matrix4d twist = Eigen::Matrix4d::Zero();
    twist.topLeftCorner<3, 3>() = cross_matrix<double>(Vector3<double>(step.segment<3>(3)));
    twist.topRightCorner<3, 1>() = step.head<3>();
    Q moved;
    integrators::move(some_pose(), step, moved);
    EXPECT_LT((pose(moved) - pose(some_pose()) * twist.exp()).cwiseAbs().maxCoeff(), 1e-14 * (1 + 10 * size)) << size;
    EXPECT_EQ(moved.tail<2>(), some_pose().tail<2>() + step.tail<2>());
  }
}

// (1 − cos a) / a² and (a − sin a) / a³, times which steps are a and a², and what quaternions turn by: to the last digit at all
// angles.
template <class T>
void expect_whole_coefficients() {
  for (double angle = 1e-4; angle < 3; angle *= 1.01) {
    const T squared = static_cast<T>(angle) * static_cast<T>(angle);
    integrators::detail::Screw<T> screw;
    integrators::detail::screw_of<T>(squared, screw);
    const long double x = squared, a = std::sqrt(x), half = std::sin(a / 2);
    long double series = 0, term = 1 / 6.0L;  // (a − sin a) / a³
    for (int k = 4; k < 60; k += 2) series += term, term *= -x / (k * (k + 1));
    constexpr long double epsilon = std::numeric_limits<T>::epsilon();
    EXPECT_LT(std::abs(screw.first - 2 * half * half / x) * a, 2 * epsilon) << angle;
    EXPECT_LT(std::abs(screw.second - series) * x, 2 * epsilon) << angle;
    EXPECT_LT(std::abs(screw.sine - half / a) * a, epsilon) << angle;
    EXPECT_LT(std::abs(screw.cosine - std::cos(a / 2)), epsilon) << angle;
  }
}
TEST(Move, CoefficientsAreRightToTheLastDigit) {
  expect_whole_coefficients<double>();
  expect_whole_coefficients<float>();
}

TEST(Move, GoesBackWhereItCameFromAndKeepsTheQuaternionsLength) {
  V step;
  step << 0.05, -0.03, 0.08, 0.04, 0.06, -0.07, 0.01, 0.02;
  Q q = some_pose();
  for (int i = 0; i < 100000; ++i) integrators::move(q, step, q);
  EXPECT_NEAR(q.segment<4>(3).norm(), 1, 4e-16);
  const V back = -step;
  for (int i = 0; i < 100000; ++i) integrators::move(q, back, q);
  EXPECT_LT((q - some_pose()).cwiseAbs().maxCoeff(), 1e-8);
}

// The rate of a step, against differences: d/dt of q · exp(step(t)) is the twist v.
TEST(RateOfStep, IsDexpInverse) {
  V step, v;
  step << 0.02, -0.01, 0.03, 0.02, 0.01, -0.02, 0.1, 0.2;
  v << 1, -2, 0.5, 0.7, -1.1, 0.3, 2, 3;
  const V rate = integrators::rate_of_step(some_pose(), step, v);
  const double h = 1e-5;
  Q ahead, behind;
  integrators::move(some_pose(), V(step + h * rate), ahead);
  integrators::move(some_pose(), V(step - h * rate), behind);
  Q at;
  integrators::move(some_pose(), step, at);
  const Eigen::Matrix4d twist = pose(at).inverse() * (pose(ahead) - pose(behind)) / (2 * h);
  EXPECT_LT((twist.topRightCorner<3, 1>() - v.head<3>()).norm(), 1e-6);
  EXPECT_LT((twist.topLeftCorner<3, 3>() - cross_matrix<double>(Vector3<double>(v.segment<3>(3)))).norm(), 1e-6);
  EXPECT_EQ(rate.tail<2>(), v.tail<2>());
}

// Sizes are fixed: Eigen throws here where it would allocate.
TEST(Steps, AllocateNothing) {
  static System<FreeMahru> system;
  system.stiffness.tail<25>().setConstant(100);
  System<FreeMahru>::VectorQ q = System<FreeMahru>::VectorQ::Zero();
  q[6] = 1;
  System<FreeMahru>::VectorV v = System<FreeMahru>::VectorV::Constant(0.1);
  Eigen::internal::set_is_malloc_allowed(false);
  EXPECT_NO_THROW(integrators::semi_implicit_euler(system, 1e-3, q, v));
  EXPECT_NO_THROW(integrators::rk4(system, 1e-3, q, v));
  EXPECT_NO_THROW(integrators::linearly_implicit(system, 1e-3, q, v));
  EXPECT_NO_THROW(integrators::implicit_midpoint(system, 1e-3, q, v));
  EXPECT_THROW(Eigen::MatrixXd(40, 40), std::logic_error) << "the test sees allocations";
  Eigen::internal::set_is_malloc_allowed(true);
}

}  // namespace
}  // namespace dalembert::testing
