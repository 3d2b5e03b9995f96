// Random trees with rows of constraints, in long double, for the kernels that solve for them.
#pragma once

// Products of what is dense here are sums written out: Eigen's for large matrices take half a minute to compile.
#define EIGEN_CACHEFRIENDLY_PRODUCT_THRESHOLD 100

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <dalembert/constraint_support.hpp>
#include <dalembert/constraints.hpp>
#include <random>
#include <vector>

namespace dalembert {
namespace {

using Real = long double;
constexpr int most = 64;
template <class T>
using Dense = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, 0, most, most>;
template <class T>
using Column = Eigen::Matrix<T, Eigen::Dynamic, 1, 0, most, 1>;
using Matrix = Dense<Real>;
using Vector = Column<Real>;

constexpr int n = 22;  // coordinates of every tree

// ConstraintRows as numbers: what the kernels are compared with is compiled once.
struct Shape {
  int count;
  const int *rows, *lengths;
  const int* const* paths;
  int (*first)(int);
  const int* above;  // the coordinate above each

  int all() const { return first(count); }
  bool knows(int c, int k) const { return std::find(paths[c], paths[c] + lengths[c], k) != paths[c] + lengths[c]; }
};
template <class Rows>
Shape shape_of(const int* above) {
  return {Rows::count, Rows::rows, Rows::lengths, Rows::paths, [](int c) { return Rows::first(c); }, above};
}

struct System {
  Shape shape;
  Matrix M, J, U;  // U: above its diagonal
  Vector D;

  System(const Shape& of, unsigned seed) : shape(of) {
    std::mt19937 engine(seed);
    const auto draw = [&] { return std::uniform_real_distribution<double>(-1, 1)(engine); };
    U = Matrix::Identity(n, n);
    D.resize(n);
    for (int k = 0; k < n; ++k) {
      D[k] = 1.5 + draw();
      for (int i = shape.above[k]; i >= 0; i = shape.above[i]) U(i, k) = draw();
    }
    M = U * D.asDiagonal() * U.transpose();
    J = Matrix::Zero(shape.all(), n);
    for (int c = 0; c < shape.count; ++c)
      for (int k = 0; k < shape.lengths[c]; ++k)
        for (int r = shape.first(c); r < shape.first(c + 1); ++r) J(r, shape.paths[c][k]) = draw();
  }
  Matrix along() const { return J * M.inverse() * J.transpose(); }
};

template <class T>
Dense<T> in(const Matrix& m) {
  return m.cast<T>();
}

// What the rows that act ask for, to the last digit: KKT by a complete orthogonal decomposition, which minds no redundancy.
std::pair<Vector, Vector> dense(const System& s, const Vector& effort, const Vector& right, const std::vector<double>& active,
                                const std::vector<double>& regularization) {
  Matrix J = s.J;
  Vector b = right;
  Matrix R = Matrix::Zero(J.rows(), J.rows());
  for (int c = 0; c < s.shape.count; ++c)
    for (int r = s.shape.first(c); r < s.shape.first(c + 1); ++r) {
      if (active[c] > 0) R(r, r) = regularization[r];
      else J.row(r).setZero(), b[r] = 0;
    }
  const Matrix inverse = s.M.inverse(), G = J * inverse * J.transpose() + R;
  Eigen::CompleteOrthogonalDecomposition<Matrix> along(G.rows(), G.cols());
  along.setThreshold(1e-12L);
  along.compute(G);
  const Vector forces = along.solve(b - J * inverse * effort);
  return {inverse * (effort + J.transpose() * forces), forces};
}

Real error(const Vector& a, const Vector& b) { return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff(); }

Vector numbers(int count, double shift) {
  Vector x(count);
  for (int i = 0; i < count; ++i) x[i] = std::sin(shift + 1.7 * i);
  return x;
}

// V and J of articulated bodies, and wrenches on the base: M's U is V_k.J_i, and J's rows wrench.J_k.
struct Limbs {
  Matrix gain{6, n}, joint{6, n}, wrenches;

  Limbs(System& s, unsigned seed) : wrenches(s.shape.all(), 6) {
    std::mt19937 engine(seed);
    const auto draw = [&] { return std::uniform_real_distribution<double>(-0.7, 0.7)(engine); };
    for (Matrix* m : {&gain, &joint, &wrenches}) *m = m->unaryExpr([&](Real) { return Real(draw()); });
    joint.leftCols(6).setIdentity();
    for (int k = 0; k < 6; ++k) gain.col(k).tail(6 - k).setZero(), gain(k, k) = 1;
    s.U.setIdentity();
    s.J.setZero();
    for (int k = 0; k < n; ++k)
      for (int i = s.shape.above[k]; i >= 0; i = s.shape.above[i]) s.U(i, k) = gain.col(k).dot(joint.col(i));
    for (int c = 0; c < s.shape.count; ++c)
      for (int k = 0; k < s.shape.lengths[c]; ++k)
        for (int r = s.shape.first(c); r < s.shape.first(c + 1); ++r)
          s.J(r, s.shape.paths[c][k]) = wrenches.row(r).dot(joint.col(s.shape.paths[c][k]));
    s.M = s.U * s.D.asDiagonal() * s.U.transpose();
  }
};

// Where limbs leave V, J and D of the joints: arrays, or slots that limbs beside each other share.
struct InArrays {
  Eigen::MatrixXd gain, joint, pivots;

  InArrays(const Limbs& limbs, const Vector& D)
      : gain(limbs.gain.cast<double>()), joint(limbs.joint.cast<double>()), pivots(D.cast<double>()) {}
  LimbsInArrays<double> limbs() const { return {gain.data(), joint.data(), pivots.data()}; }
  // Constraints at 12, 16 and 21 name the joints in order.
  AxesInArray<double> axes() const { return {joint.data() + 36}; }
};
template <int... slots>
struct InSlots : InArrays {
  static constexpr int stride = 24, slot[] = {slots...};
  std::vector<double> pivot_slots, gains, linear, angular;

  InSlots(const Limbs& from, const Vector& D)
      : InArrays(from, D), pivot_slots(stride, 7.0), gains(6 * stride, 7.0), linear(3 * stride, 7.0), angular(3 * stride, 7.0) {
    const auto put = [](std::vector<double>& to, int component, int at, double x) {
      to[static_cast<size_t>(component * stride + at)] = x;
    };
    for (int k = 6; k < n; ++k) {
      const int at = slot[k - 6];
      put(pivot_slots, 0, at, pivots(k));
      for (int c = 0; c < 6; ++c) {
        put(gains, c, at, gain(c, k));
        put(c < 3 ? linear : angular, c % 3, at, joint(c, k));
      }
    }
  }
  LimbsInSlots<double, 6, stride, slots...> limbs() const {
    return {pivot_slots.data(), gains.data(), linear.data(), angular.data(), gain.data(), pivots.data()};
  }
  LimbsInSlots<double, 6, stride, slots...> axes() const { return limbs(); }
};

// What rows along the world's axes bear in inverse dynamics, by points, and as wrenches on the base.
template <class Rows, class Where>
void expect_support_at_points(const int* above) {
  System s(shape_of<Rows>(above), 3);
  const Limbs limbs(s, 3);
  const Where where(limbs, s.D);
  const Eigen::Matrix3d turn = Eigen::Quaterniond(0.4, -0.3, 0.7, 0.2).normalized().toRotationMatrix();
  const int all = s.shape.all(), count = Rows::count;
  const Eigen::VectorXd points = numbers(3 * count, 4).cast<double>();
  Eigen::MatrixXd wrenches = Eigen::MatrixXd::Zero(all, 6);
  std::vector<double> weights;
  for (int c = 0; c < count; ++c)
    for (int r = 0; r < Rows::rows[c]; ++r) {
      const Eigen::Vector3d along = Eigen::Vector3d::Unit(r % 3), point = points.segment<3>(3 * c);
      const int row = Rows::first(c) + r;
      if (r < 3) wrenches.row(row) << along.transpose() * turn, point.cross(along).transpose() * turn;
      else wrenches.row(row).tail(3) = along.transpose() * turn;
      weights.push_back(0.5 + 0.1 * row);
    }
  const Vector effort = numbers(n, 1);
  for (unsigned mask = 0; mask < (1u << count); ++mask) {
    SCOPED_TRACE(mask);
    std::vector<double> active;
    for (int c = 0; c < count; ++c) active.push_back((mask >> c) & 1u ? 1 : 0);
    Eigen::VectorXd forces(all), expected_forces(all), to = effort.cast<double>(), expected = to;
    const auto status = support_by_wrenches<n, Rows>(where.axes(), wrenches.data(), active.data(), weights.data(),
                                                     expected_forces.data(), expected.data());
    const auto own = support_at_points<n, Rows>(where.axes(), turn.data(), points.data(), active.data(), weights.data(),
                                                forces.data(), to.data());
    // Of what points cannot bear, products with numbers of 1/mu are left.
    const double tolerance = status.rank == 6 || status.rank == 0 ? 1e-11 : 1e-6;
    EXPECT_LT((to - expected).cwiseAbs().maxCoeff(), tolerance * effort.cast<double>().cwiseAbs().maxCoeff());
    EXPECT_LE((forces - expected_forces).cwiseAbs().maxCoeff(), tolerance * expected_forces.cwiseAbs().maxCoeff());
    EXPECT_EQ(own.rank, status.rank);
    EXPECT_NEAR(own.residual, status.residual, tolerance * 10);
  }
}

}  // namespace
}  // namespace dalembert
