// The runtime's functions for rows of constraints, on random trees, against dense algebra.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <dalembert/constraints.hpp>
#include <random>
#include <vector>

namespace dalembert {
namespace {

using Real = long double;
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

// A base of six coordinates, a limb of three on it, two limbs of four on that, and one of five on the base.
constexpr int n = 22, longest = 13;
constexpr int chain_begin[] = {0, 6, 9, 13, 17, 22}, chain_above[] = {-1, 0, 1, 1, 0}, chain_depth[] = {0, 6, 9, 9, 6};
constexpr Chains chains{5, chain_begin, chain_above, chain_depth};
constexpr int above[n] = {-1, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 8, 13, 14, 15, 5, 17, 18, 19, 20};

template <int count>
struct System {
  std::vector<int> first{0}, path, begin{0};
  Matrix M, J, U;  // U: above its diagonal
  Vector D;

  // ends: the last coordinate that moves each constraint's body.
  System(const std::array<int, count>& ends, const std::array<int, count>& rows, unsigned seed) {
    std::mt19937 engine(seed);
    const auto draw = [&] { return std::uniform_real_distribution<double>(-1, 1)(engine); };
    U = Matrix::Identity(n, n);
    D.resize(n);
    for (int k = 0; k < n; ++k) {
      D[k] = 1.5 + draw();
      for (int i = above[k]; i >= 0; i = above[i]) U(i, k) = draw();
    }
    M = U * D.asDiagonal() * U.transpose();
    int all = 0;
    for (const int r : rows) all += r;
    J = Matrix::Zero(all, n);
    for (int c = 0; c < count; ++c) {
      std::vector<int> own;
      for (int k = ends[c]; k >= 0; k = above[k]) own.push_back(k);
      path.insert(path.end(), own.rbegin(), own.rend());
      begin.push_back(static_cast<int>(path.size()));
      for (const int k : own)
        for (int r = 0; r < rows[c]; ++r) J(first.back() + r, k) = draw();
      first.push_back(first.back() + rows[c]);
    }
  }
  ConstraintPaths paths() const { return {first.data(), path.data(), begin.data()}; }
  Matrix along() const { return J * M.inverse() * J.transpose(); }
};

template <class T>
Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> in(const Matrix& m) {
  return m.cast<T>();
}

template <class T>
struct Result {
  Vector x, forces;
  ConstraintStatus<T> status;
};

template <class T, int count, int rows>
Result<T> solved(const System<count>& s, const Vector& effort, const Vector& right, const std::vector<T>& active,
                 const std::vector<T>& regularization) {
  const auto J = in<T>(s.J), U = in<T>(s.U), D = in<T>(s.D), b = in<T>(right);
  Eigen::Matrix<T, Eigen::Dynamic, 1> x = effort.cast<T>(), forces(s.J.rows());
  std::vector<T> room(static_cast<size_t>(constraint_room(count, rows, longest)), T(7));  // what was there before is not read
  Result<T> result;
  result.status = solve_constrained<n, count, rows, longest>(s.paths(), chains, J.data(), U.data(), D.data(), b.data(),
                                                            active.data(), regularization.data(), room.data(), forces.data(),
                                                            x.data());
  result.x = x.template cast<Real>();
  result.forces = forces.template cast<Real>();
  return result;
}

// What the rows that act ask for, to the last digit: KKT by a complete orthogonal decomposition, which minds no redundancy.
template <int count>
std::pair<Vector, Vector> dense(const System<count>& s, const Vector& effort, const Vector& right,
                                const std::vector<double>& active, const std::vector<double>& regularization) {
  Matrix J = s.J;
  Vector b = right;
  Matrix R = Matrix::Zero(J.rows(), J.rows());
  for (int c = 0; c < count; ++c)
    for (int r = s.first[c]; r < s.first[c + 1]; ++r) {
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

template <int count, int rows>
void expect_dense(const std::array<int, count>& ends, const std::array<int, count>& own_rows, double tolerance) {
  for (unsigned seed = 1; seed < 6; ++seed) {
    const System<count> s(ends, own_rows, seed);
    const int all = s.first.back();
    const Vector effort = numbers(n, 1), right = numbers(all, 2);
    for (unsigned mask = 0; mask < (1u << count); ++mask) {
      std::vector<double> active, none(static_cast<size_t>(all), 0.0), some = none;
      for (int c = 0; c < count; ++c) active.push_back((mask >> c) & 1u ? 1 : 0);
      for (size_t r = 0; r < some.size(); ++r) some[r] = 0.1 + 0.01 * static_cast<double>(r);
      for (const std::vector<double>& regularization : {none, some}) {
        SCOPED_TRACE(testing::Message() << "seed " << seed << ", mask " << mask << ", R " << regularization.front());
        const auto [x, forces] = dense<count>(s, effort, right, active, regularization);
        const Result<double> result = solved<double, count, rows>(s, effort, right, active, regularization);
        EXPECT_LT(error(result.x, x), tolerance);
        if (mask == 0) {
          EXPECT_EQ(result.forces.cwiseAbs().maxCoeff(), 0);
          continue;
        }
        EXPECT_LT(error(result.forces, forces), tolerance);
        EXPECT_LT(result.status.residual, tolerance * 10);
        int acting = 0;
        for (int c = 0; c < count; ++c) acting += active[c] > 0 ? own_rows[c] : 0;
        EXPECT_EQ(result.status.rank, acting);
      }
    }
  }
}

TEST(ConstraintKernels, OneWeldIsWhatDenseAlgebraSays) { expect_dense<1, 6>({12}, {6}, 1e-9); }
TEST(ConstraintKernels, TwoWeldsOnLimbsAre) { expect_dense<2, 6>({12, 21}, {6, 6}, 1e-9); }
TEST(ConstraintKernels, PointsWhoseBodiesShareALimbAre) { expect_dense<4, 3>({12, 16, 8, 21}, {3, 3, 3, 3}, 1e-9); }
TEST(ConstraintKernels, WeldsAndPointsMixedAre) { expect_dense<3, 6>({16, 21, 12}, {3, 6, 3}, 1e-9); }
TEST(ConstraintKernels, TheBaseItselfIs) { expect_dense<2, 6>({5, 21}, {3, 6}, 1e-9); }

TEST(ConstraintKernels, FloatsAre) {
  const System<2> s({12, 21}, {6, 3}, 3);
  const Vector effort = numbers(n, 1), right = numbers(9, 2);
  const auto [x, forces] = dense<2>(s, effort, right, {1, 1}, std::vector<double>(9, 0.0));
  const Result<float> result = solved<float, 2, 6>(s, effort, right, {1, 1}, std::vector<float>(9, 0.f));
  EXPECT_LT(error(result.x, x), 1e-3);
  EXPECT_LT(error(result.forces, forces), 1e-3);
}

TEST(ConstraintKernels, DelassusMatrixIsJTimesTheInverseTimesJ) {
  const System<3> s({16, 21, 12}, {3, 6, 3}, 2);
  const auto J = in<double>(s.J), U = in<double>(s.U), D = in<double>(s.D);
  std::vector<double> room(static_cast<size_t>(constraint_room(3, 6, longest)), 7.0);
  Eigen::MatrixXd along(12, 12);
  delassus<n, 3, 6, longest>(s.paths(), J.data(), U.data(), D.data(), room.data(), along.data());
  const Matrix expected = s.along();
  EXPECT_LT((along.cast<Real>() - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.cwiseAbs().maxCoeff());
}

// Six points of one limb of which rows say the same: rank 6 of 18, and of the rest what the others say.
TEST(ConstraintKernels, RedundantRowsChangeNoAcceleration) {
  System<3> s({12, 12, 21}, {6, 6, 6}, 4);
  s.J.middleRows(6, 6) = s.J.topRows(6);  // twice the same
  const Vector effort = numbers(n, 1);
  Vector right = numbers(18, 2);
  right.segment(6, 6) = right.head(6);
  const std::vector<double> active{1, 1, 1}, none(18, 0.0);
  const auto [x, forces] = dense<3>(s, effort, right, active, none);
  const Result<double> result = solved<double, 3, 6>(s, effort, right, active, none);
  EXPECT_LT(error(result.x, x), 1e-9);
  EXPECT_EQ(result.status.rank, 12);
  EXPECT_LT(result.status.least_pivot, 1e-6);
  EXPECT_GT(result.status.least_pivot, 0);
  EXPECT_LT(result.status.residual, 1e-6);
}

// Rows that no joint moves, and that ask for what cannot be: no number is lost.
TEST(ConstraintKernels, RowsThatNothingMovesGiveNumbers) {
  System<2> s({12, 21}, {6, 6}, 4);
  s.J.middleRows(6, 6).setZero();
  const Vector effort = numbers(n, 1), right = numbers(12, 2);
  const Result<double> result = solved<double, 2, 6>(s, effort, right, {1, 1}, std::vector<double>(12, 0.0));
  const auto [x, forces] = dense<2>(s, effort, right, {1, 0}, std::vector<double>(12, 0.0));
  EXPECT_TRUE(result.forces.allFinite());
  EXPECT_LT(error(result.x, x), 1e-9);
  EXPECT_GT(result.status.residual, 0.1);
  EXPECT_EQ(result.status.rank, 6);
}

// Nothing of a constraint that does not act reaches any number but its own rows', which are zero.
TEST(ConstraintKernels, AMaskedConstraintChangesNothingByABit) {
  System<3> s({12, 21, 16}, {6, 6, 3}, 5);
  const Vector effort = numbers(n, 1);
  Vector right = numbers(15, 2);
  std::vector<double> regularization(15, 0.01);
  const Result<double> before = solved<double, 3, 6>(s, effort, right, {1, 0, 1}, regularization);
  s.J.middleRows(6, 6) *= 3;
  right.segment(6, 6) *= 100;
  for (size_t r = 6; r < 12; ++r) regularization[r] = 55;
  const Result<double> after = solved<double, 3, 6>(s, effort, right, {1, 0, 1}, regularization);
  for (int i = 0; i < n; ++i) EXPECT_EQ(before.x[i], after.x[i]);
  for (int r = 0; r < 15; ++r) EXPECT_EQ(before.forces[r], after.forces[r]);
  EXPECT_EQ(before.status.residual, after.status.residual);
  EXPECT_EQ(after.status.rank, 9);
  // It is not so that nothing reaches them.
  const Result<double> acting = solved<double, 3, 6>(s, effort, right, {1, 1, 1}, regularization);
  EXPECT_GT((acting.x - after.x).cwiseAbs().maxCoeff(), 1e-3);
}

}  // namespace
}  // namespace dalembert
