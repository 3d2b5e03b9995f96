// The whole-body law and its parts: the quadratic program, and what a sole can exert.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>

#include "law.hpp"
#include "qp.hpp"
#include "sole.hpp"

namespace standing {
namespace {

constexpr double none = std::numeric_limits<double>::infinity();

std::mt19937 generator(20261124);
double uniform() { return std::uniform_real_distribution<double>(-1, 1)(generator); }
template <class Matrix>
void randomise(Matrix& m) {
  for (Eigen::Index i = 0; i < m.size(); ++i) m.data()[i] = uniform();
}

// H with eigenvalues from 1 down to 1/condition.
template <int n, int rows>
void random_cost(Qp<n, rows>& qp, double condition) {
  Eigen::Matrix<double, n, n, Eigen::RowMajor> root;
  randomise(root);
  Eigen::Matrix<double, n, 1> scale;
  for (int i = 0; i < n; ++i) scale[i] = std::pow(condition, -0.5 * i / std::max(1, n - 1));
  qp.H = root.transpose() * scale.cwiseAbs2().asDiagonal() * root + 1e-3 / condition * Eigen::Matrix<double, n, n>::Identity();
  randomise(qp.g);
}

// The conditions of Karush, Kuhn and Tucker, which are enough for a convex program: x is the solution if there are multipliers
// like these.
template <int n, int rows>
void expect_optimal(const Qp<n, rows>& qp, double tolerance) {
  const Eigen::Matrix<double, n, 1> gradient = qp.H * qp.x + qp.g, pull = qp.A.transpose() * qp.multipliers;
  const double size = std::max({1.0, qp.g.norm(), (qp.H * qp.x).norm(), pull.norm()});
  EXPECT_LE((gradient - pull).norm(), tolerance * size);
  const Eigen::Matrix<double, rows, 1> values = qp.A * qp.x;
  for (int i = 0; i < rows; ++i) {
    const double unit = tolerance * (1 + qp.A.row(i).norm() * qp.x.norm());
    EXPECT_GE(values[i], qp.lower[i] - unit);
    EXPECT_LE(values[i], qp.upper[i] + unit);
    if (qp.multipliers[i] != 0) {
      EXPECT_NEAR(values[i], qp.multipliers[i] > 0 ? qp.lower[i] : qp.upper[i], unit);
    }
  }
}

// Rows around a random point, so that there is a solution: some through it, some far, some with two bounds, some equations.
template <int n, int rows>
void random_rows(Qp<n, rows>& qp, int equations) {
  randomise(qp.A);
  Eigen::Matrix<double, n, 1> inside;
  randomise(inside);
  const Eigen::Matrix<double, rows, 1> at = qp.A * inside;
  for (int i = 0; i < rows; ++i) {
    const bool through = uniform() > 0.5;
    const double below = through ? 0 : std::fabs(uniform()), above = through ? 0 : std::fabs(uniform());
    qp.lower[i] = uniform() > -0.5 ? at[i] - below : -none;
    qp.upper[i] = uniform() > 0 ? at[i] + above + 0.1 : none;
    if (i < equations) qp.lower[i] = qp.upper[i] = at[i];
  }
}

template <int n, int rows>
void random_problems(int problems, int equations, double condition, double tolerance) {
  for (int problem = 0; problem < problems; ++problem) {
    SCOPED_TRACE(problem);
    Qp<n, rows> qp;
    random_cost(qp, condition);
    random_rows(qp, equations);
    qp.g *= 3;
    ASSERT_EQ(qp.solve(), QpStatus::solved);
    expect_optimal(qp, tolerance);
  }
}

TEST(Qp, RandomProblemsMeetTheConditionsOfOptimality) {
  random_problems<6, 24>(300, 1, 10, 1e-9);
  random_problems<12, 59>(500, 0, 1e2, 1e-8);
  random_problems<12, 59>(200, 6, 1e4, 1e-7);
}

TEST(Qp, RowsThatSayTheSameAreTakenInOnce) {
  for (int problem = 0; problem < 300; ++problem) {
    SCOPED_TRACE(problem);
    Qp<6, 24> qp;
    random_cost(qp, 100);
    random_rows(qp, 0);
    for (int i = 12; i < 24;
         ++i) {  // the first twelve again: as they are, in other units, or sums of two with the sum's bounds
      const int j = i - 12, k = (j + 1) % 12;
      const double unit = i % 3 ? std::pow(10, 2 * uniform()) : 1;
      qp.A.row(i) = unit * (qp.A.row(j) + (i % 2) * qp.A.row(k));
      qp.lower[i] = unit * (qp.lower[j] + (i % 2 ? qp.lower[k] : 0));
      qp.upper[i] = unit * (qp.upper[j] + (i % 2 ? qp.upper[k] : 0));
    }
    ASSERT_EQ(qp.solve(), QpStatus::solved);
    expect_optimal(qp, 1e-8);
  }
}

// More rows through the solution than unknowns: the tip of a cone, where a foot that bears nothing is.
TEST(Qp, EndsAtTheTipOfACone) {
  for (int problem = 0; problem < 100; ++problem) {
    SCOPED_TRACE(problem);
    Qp<6, 24> qp;
    random_cost(qp, 100);
    qp.A << sole_constraints(0.5, 0.11, 0.05), Eigen::Matrix<double, 24 - sole_rows, 6>::Zero();
    qp.lower.setZero();
    qp.upper.setConstant(none);
    qp.g[2] = 100;  // wants to pull at the ground
    ASSERT_EQ(qp.solve(), QpStatus::solved);
    expect_optimal(qp, 1e-8);
    EXPECT_LE(qp.x.norm(), 1e-6);
  }
}

TEST(Qp, ContradictionsAreFoundOut) {
  for (int problem = 0; problem < 300; ++problem) {
    SCOPED_TRACE(problem);
    Qp<6, 24> qp;
    random_cost(qp, 100);
    random_rows(qp, 0);
    // A sum of three rows is to be above what their upper bounds allow.
    for (int i = 0; i < 3; ++i) qp.upper[i] = std::fmax(0, qp.lower[i]) + 1;
    qp.A.row(3) = qp.A.row(0) + qp.A.row(1) + qp.A.row(2);
    qp.lower[3] = qp.upper[0] + qp.upper[1] + qp.upper[2] + 1e-3;
    qp.upper[3] = none;
    EXPECT_EQ(qp.solve(), QpStatus::infeasible);
  }
  Qp<2, 1> qp;
  qp.H.setIdentity(), qp.g.setZero(), qp.A << 1, 0;
  qp.lower << 1, qp.upper << 0;
  EXPECT_EQ(qp.solve(), QpStatus::infeasible);
  qp.A.setZero(), qp.lower << 1, qp.upper << 2;  // 0 ≥ 1
  EXPECT_EQ(qp.solve(), QpStatus::infeasible);
}

TEST(Qp, WhatIsNoProgramIsRefused) {
  Qp<2, 1> qp;
  const auto reset = [&] { qp.H.setIdentity(), qp.g.setOnes(), qp.A << 1, 0, qp.lower << 0, qp.upper << 1; };
  reset();
  EXPECT_EQ(qp.solve(), QpStatus::solved);
  EXPECT_EQ(qp.x, Eigen::Vector2d(0, -1));
  EXPECT_EQ(qp.multipliers[0], 1);
  reset(), qp.H(1, 1) = 0;
  EXPECT_EQ(qp.solve(), QpStatus::not_convex);
  reset(), qp.H(1, 1) = -1;
  EXPECT_EQ(qp.solve(), QpStatus::not_convex);
  for (double* number : {&qp.H(1, 0), &qp.g[1], &qp.A(0, 1)}) {
    reset(), *number = std::nan("");
    EXPECT_EQ(qp.solve(), QpStatus::not_convex);
  }
  for (double* number : {&qp.lower[0], &qp.upper[0]}) {
    reset(), *number = std::nan("");
    EXPECT_EQ(qp.solve(), QpStatus::infeasible);
  }
}

// Wrenches of four forces inside their pyramids satisfy the rows; along every row some reach its bound; and what violates a row
// by a thousandth is no sum of such forces, by the program itself: the least distance to one is above zero.
TEST(Sole, RowsAreWhatTheCornersCanExert) {
  constexpr double mu = 0.6, X = 0.12, Y = 0.06;
  const auto C = sole_constraints(mu, X, Y);
  Eigen::Matrix<double, 6, 12> corners;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d p(i & 1 ? X : -X, i & 2 ? Y : -Y, 0);
    for (int axis = 0; axis < 3; ++axis)
      corners.col(3 * i + axis) << Eigen::Vector3d::Unit(axis), p.cross(Eigen::Vector3d::Unit(axis));
  }
  Eigen::Matrix<double, sole_rows, 1> least = Eigen::Matrix<double, sole_rows, 1>::Constant(none);
  for (int draw = 0; draw < 20000; ++draw) {
    Eigen::Matrix<double, 12, 1> forces;
    for (int i = 0; i < 4; ++i) {
      const double press = std::fmax(0, uniform());
      const auto slide = [&] { return draw % 2 ? mu * press * uniform() : std::copysign(mu * press, uniform()); };
      forces.segment<3>(3 * i) << slide(), slide(), press;
    }
    const Eigen::Matrix<double, 6, 1> wrench = corners * forces;
    const Eigen::Matrix<double, sole_rows, 1> margin = C * wrench;
    ASSERT_GE(margin.minCoeff(), -1e-12);
    least = least.cwiseMin(margin / wrench[2]);
    const SoleUse use = sole_use(wrench, mu * std::sqrt(2.0), X, Y);
    ASSERT_LE(use.friction, 1 + 1e-12);
    ASSERT_LE(use.pressure, 1 + 1e-12);
  }
  EXPECT_LE(least.maxCoeff(), 1e-3);  // every row is reached

  // The nearest sum of corner forces to a wrench: ‖corners f − wrench‖² with f inside the pyramids.
  const auto distance = [&](const Eigen::Matrix<double, 6, 1>& wrench) {
    Qp<12, 59> qp;
    qp.H = corners.transpose() * corners + 1e-9 * Eigen::Matrix<double, 12, 12>::Identity();
    qp.g = -corners.transpose() * wrench;
    qp.A.setZero(), qp.lower.setZero(), qp.upper.setConstant(none);
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 5; ++k) {
        qp.A(5 * i + k, 3 * i + 2) = k < 4 ? mu : 1;
        if (k < 4) qp.A(5 * i + k, 3 * i + k / 2) = k % 2 ? 1 : -1;
      }
    EXPECT_EQ(qp.solve(1e-12), QpStatus::solved);
    return (corners * qp.x - wrench).norm();
  };
  int inside = 0, outside = 0;
  for (int draw = 0; draw < 2000; ++draw) {
    Eigen::Matrix<double, 6, 1> wrench;
    wrench << mu * uniform(), mu * uniform(), 1, Y * uniform(), X * uniform(), mu * (X + Y) * uniform();
    const double margin = (C * wrench).minCoeff();
    if (margin > 0) {
      ++inside;
      EXPECT_LE(distance(wrench), 1e-5) << wrench.transpose();
    } else if (margin < -1e-3) {
      ++outside;
      EXPECT_GE(distance(wrench), 1e-4) << wrench.transpose();
    }
  }
  EXPECT_GT(inside, 50);
  EXPECT_GT(outside, 50);
}

TEST(Sole, AFootInTheAirUsesNothing) {
  Eigen::Matrix<double, 6, 1> wrench = Eigen::Matrix<double, 6, 1>::Zero();
  EXPECT_EQ(sole_use(wrench, 0.5, 0.12, 0.06).friction, 0);
  wrench[0] = 1;
  EXPECT_EQ(sole_use(wrench, 0.5, 0.12, 0.06).friction, none);
}

// With the law's torques and forces the equations of motion give accelerations with which the feet do as they are told: nothing
// is lost by eliminating v̇. Forces and torques are inside their limits, tight ones too.
TEST(Law, ForcesAndTorquesAreThoseOfTheEquationsOfMotion) {
  using mahru_on_feet::Joint;
  State stance;
  const auto bend = [&](Joint hip, Joint knee, Joint ankle) {
    stance.q[q_index(hip) - 7] = stance.q[q_index(ankle) - 7] = -0.4;
    stance.q[q_index(knee) - 7] = 0.8;
  };
  bend(Joint::left_hip_pitch, Joint::left_knee, Joint::left_ankle_pitch);
  bend(Joint::right_hip_pitch, Joint::right_knee, Joint::right_ankle_pitch);
  VectorJ limits = VectorJ::Constant(100);
  for (const Joint joint : {Joint::left_knee, Joint::right_knee}) limits[q_index(joint) - 7] = 80;
  const Beliefs beliefs;
  Law law(stance, limits, beliefs);
  const Vector3d com = law.center_of_mass();
  const auto C =
      sole_constraints(beliefs.friction / std::sqrt(2.0), sole_x - beliefs.sole_margin, sole_y - beliefs.sole_margin);

  mahru_on_feet::Workspace robot;
  int at_limit = 0, gave_way = 0, on_one_foot = 0;
  for (int draw = 0; draw < 500; ++draw) {
    SCOPED_TRACE(draw);
    State state = stance;
    for (int i = 0; i < joints; ++i) state.q[i] += 0.05 * uniform(), state.v[i] = 0.2 * uniform();
    state.base_rotation = Eigen::AngleAxisd(0.1 * uniform(), Vector3d(uniform(), uniform(), uniform()).normalized());
    state.base_linear = 0.1 * Vector3d(uniform(), uniform(), uniform());
    state.base_angular = 0.1 * Vector3d(uniform(), uniform(), uniform());
    Target target;
    target.com = com + 0.05 * Vector3d(uniform(), uniform(), uniform());
    VectorJ torque;
    law.evaluate(state);
    if (draw % 3 == 0) target.foot[left].load = 0, target.foot[left].p = law.sole_pose(left).col(3), ++on_one_foot;
    law.torque(target, torque);
    gave_way += law.gave_way();
    const double share = torque.cwiseQuotient(limits).cwiseAbs().maxCoeff();
    at_limit += share > 1 - 1e-6;
    EXPECT_LE(share, 1 + 1e-9);

    mahru_on_feet::VectorQ q;
    mahru_on_feet::VectorV v;
    q << state.base_position, state.base_rotation.coeffs(), state.q;
    v << state.base_linear, state.base_angular, state.v;
    mahru_on_feet::evaluate(q, v, robot);
    Eigen::Matrix<double, 12, nv> J;
    J << mahru_on_feet::jacobian_mixed_left_sole(robot), mahru_on_feet::jacobian_mixed_right_sole(robot);
    Vector12 forces = law.forces(), drift;
    drift << mahru_on_feet::acceleration_bias_mixed_left_sole(robot), mahru_on_feet::acceleration_bias_mixed_right_sole(robot);
    for (const Side side : sides) {
      const Vector6 wrench = forces.segment<6>(6 * side);
      EXPECT_GE((C * wrench).minCoeff(), -1e-6);
      if (target.foot[side].load == 0) {
        EXPECT_EQ(wrench.norm(), 0);
      } else {
        EXPECT_GE(wrench[2], beliefs.least_load - 1e-6);
      }
      const Eigen::Matrix3d axes = law.sole_pose(side).leftCols<3>();
      forces.segment<3>(6 * side) = axes * wrench.head<3>();
      forces.segment<3>(6 * side + 3) = axes * wrench.tail<3>();
    }
    if (law.gave_way()) continue;
    mahru_on_feet::VectorV right = J.transpose() * forces - mahru_on_feet::bias(robot);
    right.tail<joints>() += torque;
    const mahru_on_feet::VectorV a = Eigen::Matrix<double, nv, nv>(mahru_on_feet::mass_matrix(robot)).llt().solve(right);
    const Vector12 feet = J * a + drift, wanted = -20 * J * v;
    for (const Side side : sides)
      if (target.foot[side].load > 0) {
        EXPECT_LE((feet - wanted).segment<6>(6 * side).norm(), 1e-6);
      }
  }
  EXPECT_GT(at_limit - gave_way, 20);
  EXPECT_LT(gave_way, 100);
  EXPECT_GT(on_one_foot, 100);
}

}  // namespace
}  // namespace standing
