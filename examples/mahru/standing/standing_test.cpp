// The parts of the whole-body law that stand alone: the quadratic program, and what a sole can exert.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>

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
  random_problems<2, 5>(300, 0, 1, 1e-9);
  random_problems<3, 10>(300, 1, 10, 1e-9);
  random_problems<12, 59>(500, 0, 1e2, 1e-8);
  random_problems<12, 59>(200, 6, 1e4, 1e-7);
  random_problems<18, 80>(200, 4, 1e2, 1e-8);
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
    Qp<6, sole_rows> qp;
    random_cost(qp, 100);
    qp.A = sole_constraints(0.5, 0.11, 0.05);
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
    Qp<6, 20> qp;
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
    Qp<12, 20> qp;
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

}  // namespace
}  // namespace standing
