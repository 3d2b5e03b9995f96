// The runtime's functions for rows of constraints, on random trees, against dense algebra.
#include <gtest/gtest.h>

#include <dalembert/constraint_response.hpp>
#include <dalembert/constraint_support.hpp>

#include "constraint_systems.hpp"

namespace dalembert {
namespace {

// A base of six coordinates, a limb of three on it, two limbs of four on that, and one of five on the base.
using Tree = ChainTree<ChainBelow<0, 6>, ChainBelow<6, 3, 0, 6>, ChainBelow<9, 4, 6, 9, 0, 6>, ChainBelow<13, 4, 6, 9, 0, 6>,
                       ChainBelow<17, 5, 0, 6>>;
constexpr int above[n] = {-1, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 8, 13, 14, 15, 5, 17, 18, 19, 20};
template <class Rows>
Shape shape() {
  return shape_of<Rows>(above);
}

// Constraints by the last coordinate that moves the body of each.
template <int rows>
using AtBase = RowPath<rows, 0, 1, 2, 3, 4, 5>;
template <int rows>
using At8 = RowPath<rows, 0, 1, 2, 3, 4, 5, 6, 7, 8>;
template <int rows>
using At12 = RowPath<rows, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12>;
template <int rows>
using At16 = RowPath<rows, 0, 1, 2, 3, 4, 5, 6, 7, 8, 13, 14, 15, 16>;
template <int rows>
using At21 = RowPath<rows, 0, 1, 2, 3, 4, 5, 17, 18, 19, 20, 21>;

// Loops between two bodies: of neighbouring limbs, of the base's two, and of one limb.
template <int rows, int linear>
using From12To16 = LoopPath<rows, linear, 9, 13, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16>;
template <int rows, int linear>
using From12To21 = LoopPath<rows, linear, 6, 13, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 17, 18, 19, 20, 21>;
template <int rows, int linear>
using From8To12 = LoopPath<rows, linear, 9, 9, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12>;

template <class T>
struct Result {
  Vector x, forces;
  ConstraintStatus<T> status;
};

template <class T>
using SolveConstrained = ConstraintStatus<T> (*)(const T* jacobian, const T* factor, const T* pivots, const T* right,
                                                 const T* active, const T* regularization, T* room, T* forces, T* x);

template <class T>
Result<T> solved(SolveConstrained<T> solve, const System& s, const Vector& effort, const Vector& right,
                 const std::vector<T>& active, const std::vector<T>& regularization) {
  const auto J = in<T>(s.J), U = in<T>(s.U), D = in<T>(s.D), b = in<T>(right);
  Column<T> x = effort.cast<T>(), forces(s.J.rows());
  std::vector<T> room(static_cast<size_t>(constraint_room(s.shape.count, 6, n, s.shape.all())),
                      T(7));  // what was there before is not read
  Result<T> result;
  result.status =
      solve(J.data(), U.data(), D.data(), b.data(), active.data(), regularization.data(), room.data(), forces.data(), x.data());
  result.x = x.template cast<Real>();
  result.forces = forces.template cast<Real>();
  return result;
}

void expect_dense(const Shape& shape, SolveConstrained<double> solve, double tolerance) {
  const int count = shape.count, all = shape.all();
  for (unsigned seed = 1; seed < 6; ++seed) {
    const System s(shape, seed);
    const Vector effort = numbers(n, 1), right = numbers(all, 2);
    for (unsigned mask = 0; mask < (1u << count); ++mask) {
      std::vector<double> active, none(static_cast<size_t>(all), 0.0), some = none;
      for (int c = 0; c < count; ++c) active.push_back((mask >> c) & 1u ? 1 : 0);
      for (size_t r = 0; r < some.size(); ++r) some[r] = 0.1 + 0.01 * static_cast<double>(r);
      for (int c = 0; c < count; ++c) {
        std::vector<double> negative = some;
        negative[static_cast<size_t>(shape.first(c))] = -0.01;
        const Result<double> result = solved(solve, s, effort, right, active, negative);
        EXPECT_EQ(result.status.least_pivot == -1, active[static_cast<size_t>(c)] > 0)
            << "constraint " << c << ", mask " << mask;
      }
      for (const std::vector<double>& regularization : {none, some}) {
        SCOPED_TRACE(testing::Message() << "seed " << seed << ", mask " << mask << ", R " << regularization.front());
        const auto [x, forces] = dense(s, effort, right, active, regularization);
        const Result<double> result = solved(solve, s, effort, right, active, regularization);
        EXPECT_LT(error(result.x, x), tolerance);
        if (mask == 0) {
          EXPECT_EQ(result.forces.cwiseAbs().maxCoeff(), 0);
          continue;
        }
        EXPECT_LT(error(result.forces, forces), tolerance);
        EXPECT_LT(result.status.residual, tolerance * 10);
        int acting = 0;
        for (int c = 0; c < count; ++c) acting += active[c] > 0 ? shape.rows[c] : 0;
        EXPECT_EQ(result.status.rank, acting);
      }
    }
  }
}

template <class Rows>
void expect_dense(double tolerance) {
  expect_dense(shape<Rows>(), solve_constrained<n, Rows, Tree, double>, tolerance);
}

// Each set with every mask, so that one constraint of it alone is among them.
TEST(ConstraintKernels, WeldsAreWhatDenseAlgebraSays) {
  expect_dense<ConstraintRows<At12<6>, At21<6>>>(1e-11);
#ifdef DALEMBERT_LONG_TESTS  // each set takes seconds to compile
  expect_dense<ConstraintRows<At16<3>, At21<6>, At12<3>>>(1e-11);
#endif
}
TEST(ConstraintKernels, PointsWhoseBodiesShareALimbAre) {
  expect_dense<ConstraintRows<At12<3>, At16<3>, At8<3>, At21<3>>>(1e-11);
}
TEST(ConstraintKernels, TheBaseItselfIs) { expect_dense<ConstraintRows<AtBase<3>, From12To16<5, 3>>>(1e-11); }

TEST(ConstraintKernels, LoopsAre) {
  expect_dense<ConstraintRows<From12To21<2, 2>, From8To12<3, 1>, At16<3>>>(1e-11);
#ifdef DALEMBERT_LONG_TESTS
  expect_dense<ConstraintRows<At21<6>, From12To16<4, 2>, From12To21<1, 1>, From8To12<6, 3>>>(1e-10);
#endif
}

// Limbs of three and five beside each other, and the two of four; the one of three alone, and the others beside each other.
using InPairs = InSlots<0, 2, 4, 10, 12, 14, 16, 11, 13, 15, 17, 1, 3, 5, 7, 9>;
using InFours = InSlots<0, 1, 2, 4, 8, 12, 16, 5, 9, 13, 17, 6, 10, 14, 18, 22>;

template <class Rows, class Where>
void expect_dense_by_limbs(double tolerance) {
  for (unsigned seed = 1; seed < 6; ++seed) {
    System s(shape<Rows>(), seed);
    const Limbs limbs(s, seed);
    const int all = s.shape.all();
    const Vector effort = numbers(n, 1), right = numbers(all, 2), start = (s.U * s.D.asDiagonal()).inverse() * effort;
    const auto wrenches = in<double>(limbs.wrenches), b = in<double>(right);
    std::vector<double> room(static_cast<size_t>(constraint_room(s.shape.count, 6, n, all)), 7.0);
    Eigen::MatrixXd along(all, all);
    const Where numbers_of_limbs(limbs, s.D);
    const auto where = numbers_of_limbs.limbs();
    delassus_by_limbs<n, Rows>(where, wrenches.data(), room.data(), along.data());
    EXPECT_LT((along.cast<Real>() - s.along()).cwiseAbs().maxCoeff(), 1e-12 * s.along().cwiseAbs().maxCoeff());
    for (unsigned mask = 0; mask < (1u << s.shape.count); ++mask) {
      std::vector<double> active, regularization;
      for (int c = 0; c < s.shape.count; ++c) active.push_back((mask >> c) & 1u ? 1 : 0);
      for (int r = 0; r < all; ++r) regularization.push_back(0.01 * r);
      const auto [expected, forces] = dense(s, effort, right, active, regularization);
      Eigen::VectorXd x = start.cast<double>(), f(all), v = Eigen::VectorXd::Ones(n), impulses(all);
      solve_constrained_by_limbs<n, Rows, Tree>(where, wrenches.data(), b.data(), active.data(), regularization.data(),
                                                room.data(), f.data(), x.data());
      EXPECT_LT(error(x.cast<Real>(), expected), tolerance) << "seed " << seed << ", mask " << mask;
      EXPECT_LE((f.cast<Real>() - forces).cwiseAbs().maxCoeff(), tolerance * forces.cwiseAbs().maxCoeff());
      solve_impact_by_limbs<n, Rows, Tree>(where, wrenches.data(), b.data(), active.data(), regularization.data(), room.data(),
                                           impulses.data(), v.data());
      const Vector after = Vector::Ones(n) + dense(s, Vector::Zero(n), right, active, regularization).first;
      EXPECT_LT(error(v.cast<Real>(), after), tolerance) << "seed " << seed << ", mask " << mask;
    }
  }
}
// Each set at slots or in arrays: every one of them takes the compiler seconds.
TEST(ConstraintKernels, LimbsGiveWhatFactorsGive) {
  expect_dense_by_limbs<ConstraintRows<At16<3>, AtBase<6>, At12<3>>, InArrays>(1e-10);
}
TEST(ConstraintKernels, LimbsBesideEachOtherGiveWhatFactorsGive) {
  expect_dense_by_limbs<ConstraintRows<At12<6>, At21<6>>, InPairs>(1e-10);
#ifdef DALEMBERT_LONG_TESTS
  expect_dense_by_limbs<ConstraintRows<At12<3>, At16<3>, At8<3>, At21<3>>, InFours>(1e-10);
#endif
}

// What constraints bear where the base alone has no motor: by all of J, and by wrenches on the base and axes of joints.
template <class Where>
void expect_support_by_wrenches() {
  using Rows = ConstraintRows<At12<6>, At16<3>, At21<3>>;
  System s(shape<Rows>(), 3);
  const Limbs limbs(s, 3);
  const Where where(limbs, s.D);
  const auto J = in<double>(s.J), wrenches = in<double>(limbs.wrenches);
  const Vector effort = numbers(n, 1);
  std::vector<double> weights;
  for (int r = 0; r < 12; ++r) weights.push_back(0.5 + 0.1 * r);
  for (const std::vector<double>& active : {std::vector<double>{1, 1, 1}, {1, 0, 1}, {0, 0, 0}}) {
    Eigen::VectorXd forces(12), expected_forces(12), to = effort.cast<double>(), expected = to;
    const auto status = support<n, Rows, Undriven<6, 0, 1, 2, 3, 4, 5>>(J.data(), active.data(), weights.data(),
                                                                        expected_forces.data(), expected.data());
    const auto own =
        support_by_wrenches<n, Rows>(where.axes(), wrenches.data(), active.data(), weights.data(), forces.data(), to.data());
    EXPECT_LT((to - expected).cwiseAbs().maxCoeff(), 1e-11 * effort.cwiseAbs().maxCoeff());
    EXPECT_LE((forces - expected_forces).cwiseAbs().maxCoeff(), 1e-11 * expected_forces.cwiseAbs().maxCoeff());
    EXPECT_EQ(own.rank, status.rank);
  }
}
TEST(ConstraintKernels, SupportByWrenchesIsWhatAllOfJGives) {
  expect_support_by_wrenches<InPairs>();
#ifdef DALEMBERT_LONG_TESTS
  expect_support_by_wrenches<InArrays>();
#endif
}

// Rows along the world's axes, of points: by these, and as wrenches on the base.
TEST(ConstraintKernels, SupportAtPointsIsWhatTheirWrenchesGive) {
  expect_support_at_points<ConstraintRows<At12<6>, At16<3>, At21<3>>, InPairs>(above);
}

// Of one point next to the base's origin nothing but mu holds its moments.
template <class T>
void expect_numbers_of_small_levers() {
  using Rows = ConstraintRows<At12<3>>;
  const std::vector<T> axes(6 * n, T(0));
  const T turn[] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, active[] = {1};
  for (const T lever : {T(1e-5), T(1), T(100)})
    for (int exponent = -12; exponent <= 12; ++exponent) {
      const T points[] = {lever, 0, lever}, weight = std::pow(T(10), T(exponent)), weights[] = {weight, weight, weight};
      T forces[3], to[n] = {0, 0, 10, 1};
      const auto status = support_at_points<n, Rows>(AxesInArray<T>{axes.data()}, turn, points, active, weights, forces, to);
      for (const T x : to) EXPECT_TRUE(std::isfinite(x)) << lever << ", 1e" << exponent;
      EXPECT_TRUE(std::isfinite(status.residual)) << lever << ", 1e" << exponent;
      EXPECT_EQ(status.rank, 3) << lever << ", 1e" << exponent;
    }
}
TEST(ConstraintKernels, SupportIsOfNumbersWhereWeightsAndLeversAreSmall) {
  expect_numbers_of_small_levers<double>();
  expect_numbers_of_small_levers<float>();
}

// f = W J_u y, J_u' f what is lacking at the coordinates u.
TEST(ConstraintKernels, SupportIsTheLeastByItsWeights) {
  using Rows = ConstraintRows<At12<6>, From12To16<5, 3>, At21<3>>;
  const System s(shape<Rows>(), 6);
  const auto J = in<double>(s.J);
  const Vector effort = numbers(n, 1);
  const int undriven[] = {0, 1, 2, 3, 4, 5, 11};
  Matrix own(14, 7);
  Vector lacking(7), weight(14);
  for (int i = 0; i < 7; ++i) own.col(i) = s.J.col(undriven[i]), lacking[i] = effort[undriven[i]];
  std::vector<double> weights;
  for (int r = 0; r < 14; ++r) weights.push_back(0.5 + 0.1 * r), weight[r] = weights.back();
  for (const std::vector<double>& active : {std::vector<double>{1, 1, 1}, {1, 0, 1}}) {
    Eigen::VectorXd forces(14), to = effort.cast<double>();
    const auto status =
        support<n, Rows, Undriven<6, 0, 1, 2, 3, 4, 5, 11>>(J.data(), active.data(), weights.data(), forces.data(), to.data());
    Vector W = weight;
    if (active[1] == 0) W.segment(6, 5).setZero();
    const Matrix G = own.transpose() * W.asDiagonal() * own;
    const Vector expected = W.asDiagonal() * own * G.ldlt().solve(lacking);
    EXPECT_LT(error(forces.cast<Real>(), expected), 1e-9);
    for (int k = 0; k < n; ++k) EXPECT_LT(std::abs(Real(to[k]) - effort[k] + s.J.col(k).dot(expected)), 1e-9);
    EXPECT_LT(status.residual, 1e-9);
    EXPECT_EQ(status.rank, 7);
    if (active[1] == 0) {
      EXPECT_EQ(forces.segment(6, 5).cwiseAbs().maxCoeff(), 0);
    }
  }
  // Nobody bears the base: it is left, and told.
  Eigen::VectorXd forces(14), to = effort.cast<double>();
  const double none[] = {0, 0, 0};
  const auto status =
      support<n, Rows, Undriven<6, 0, 1, 2, 3, 4, 5, 11>>(J.data(), none, weights.data(), forces.data(), to.data());
  EXPECT_EQ(forces.cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(status.rank, 0);
  EXPECT_GT(status.residual, 0.5);
  EXPECT_TRUE(to.allFinite());
}

// A joint whose axis goes through all points moves no row but by rounding, which forces of 1e15 would make use of: it is left.
TEST(ConstraintKernels, SupportMakesNothingOfRounding) {
  using Rows = ConstraintRows<At12<6>, From12To16<5, 3>, At21<3>>;
  System s(shape<Rows>(), 6);
  s.J.col(11).setZero();
  const auto exact = in<double>(s.J);
  for (Eigen::Index r = 0; r < s.J.rows(); ++r) s.J(r, 11) = Real(1e-17) * Real(static_cast<int>(r % 3) - 1);
  const auto rounded = in<double>(s.J);
  const std::vector<double> weights(14, 1), active(3, 1);
  const auto with = [&](const auto& J) {
    Eigen::VectorXd both(14 + n), forces(14), to = numbers(n, 1).cast<double>();
    const auto status =
        support<n, Rows, Undriven<6, 0, 1, 2, 3, 4, 5, 11>>(J.data(), active.data(), weights.data(), forces.data(), to.data());
    EXPECT_EQ(status.rank, 6);
    EXPECT_EQ(status.residual, std::abs(to[11]));
    both << forces, to;
    return both;
  };
  EXPECT_LT((with(rounded) - with(exact)).cwiseAbs().maxCoeff(), 1e-12);
}

// Weights matter by their ratio: however large or small all of them are, forces are the same. What is no weight counts as zero,
// and the status says so.
template <class Support>
void expect_any_weights(const Support& support_by, int all) {
  std::vector<double> usual;
  for (int r = 0; r < all; ++r) usual.push_back(0.5 + 0.1 * r);
  const auto with = [&](const std::vector<double>& weights) -> Result<double> {
    Result<double> result;
    Eigen::VectorXd forces(all), to = numbers(n, 1).cast<double>();
    result.status = support_by(weights.data(), forces.data(), to.data());
    result.forces = forces.cast<Real>(), result.x = to.cast<Real>();
    return result;
  };
  const auto expect_same = [&](const Result<double>& a, const Result<double>& b, double tolerance) {
    EXPECT_LE(error(a.forces, b.forces), tolerance);
    EXPECT_LE((a.x - b.x).cwiseAbs().maxCoeff(), tolerance * numbers(n, 1).cwiseAbs().maxCoeff());
    EXPECT_EQ(a.status.rank, b.status.rank);
  };
  const Result<double> expected = with(usual);
  for (const double size : {1e-307, 1e-308, 1e-200, 1e-90, 1e90, 1e200, 1e306, 9e307}) {
    SCOPED_TRACE(size);
    std::vector<double> weights = usual;
    for (double& weight : weights) weight *= size;
    const Result<double> result = with(weights);
    expect_same(result, expected, 1e-11);
    EXPECT_NEAR(result.status.least_pivot, expected.status.least_pivot, 1e-9);
  }
  for (const double wrong : {-1.0, -1e-9, HUGE_VAL, -HUGE_VAL, std::nan("")}) {
    SCOPED_TRACE(wrong);
    std::vector<double> without = usual, weights = usual;
    without[1] = 0, weights[1] = wrong;
    expect_same(with(weights), with(without), 1e-11);
    EXPECT_EQ(with(weights).forces[1], 0);
    EXPECT_EQ(with(weights).status.least_pivot, -1);
    EXPECT_GT(with(without).status.least_pivot, 0);
    const Result<double> none = with(std::vector<double>(usual.size(), wrong));
    EXPECT_EQ(none.forces.cwiseAbs().maxCoeff(), 0);
    EXPECT_EQ(none.x, numbers(n, 1).cast<double>().cast<Real>().eval());
    EXPECT_EQ(none.status.rank, 0);
    EXPECT_EQ(none.status.least_pivot, -1);
  }
  // One that is next to nothing beside others bears nothing, and does no harm.
  std::vector<double> small = usual;
  for (int r = 0; r < 6; ++r) small[static_cast<size_t>(r)] = 1e-310;
  const Result<double> rest = with(small);
  EXPECT_TRUE(rest.x.allFinite());
  EXPECT_LT(rest.forces.head(6).cwiseAbs().maxCoeff(), 1e-250L);
}
TEST(ConstraintKernels, WeightsOfSupportMatterByTheirRatio) {
  {
    using Rows = ConstraintRows<At12<6>, From12To16<5, 3>, At21<3>>;
    const auto J = in<double>(System(shape<Rows>(), 6).J);
    const double active[] = {1, 1, 1};
    expect_any_weights(
        [&](const double* weights, double* forces, double* to) {
          return support<n, Rows, Undriven<6, 0, 1, 2, 3, 4, 5, 11>>(J.data(), active, weights, forces, to);
        },
        14);
    // What is off may have weights of any kind.
    const double off[] = {1, 0, 1};
    std::vector<double> weights(14, 1.0), others = weights;
    for (size_t r = 6; r < 11; ++r) others[r] = r % 2 == 0 ? std::nan("") : -HUGE_VAL;
    Eigen::VectorXd forces(14), to = numbers(n, 1).cast<double>(), same_forces(14), same = to;
    support<n, Rows, Undriven<6, 0, 1, 2, 3, 4, 5, 11>>(J.data(), off, weights.data(), forces.data(), to.data());
    const auto status =
        support<n, Rows, Undriven<6, 0, 1, 2, 3, 4, 5, 11>>(J.data(), off, others.data(), same_forces.data(), same.data());
    EXPECT_EQ(forces, same_forces);
    EXPECT_EQ(to, same);
    EXPECT_GT(status.least_pivot, 0);
  }
  using Rows = ConstraintRows<At12<6>, At16<3>, At21<3>>;
  System s(shape<Rows>(), 3);
  const Limbs limbs(s, 3);
  const InPairs where(limbs, s.D);
  const auto wrenches = in<double>(limbs.wrenches);
  const double active[] = {1, 1, 1};
  expect_any_weights(
      [&](const double* weights, double* forces, double* to) {
        return support_by_wrenches<n, Rows>(where.axes(), wrenches.data(), active, weights, forces, to);
      },
      12);
  const Eigen::Matrix3d turn = Eigen::Quaterniond(0.4, -0.3, 0.7, 0.2).normalized().toRotationMatrix();
  const Eigen::VectorXd points = numbers(9, 4).cast<double>();
  expect_any_weights(
      [&](const double* weights, double* forces, double* to) {
        return support_at_points<n, Rows>(where.axes(), turn.data(), points.data(), active, weights, forces, to);
      },
      12);
}

TEST(ConstraintKernels, FloatsAre) {
  using Rows = ConstraintRows<At12<6>, At21<3>>;
  const System s(shape<Rows>(), 3);
  const Vector effort = numbers(n, 1), right = numbers(9, 2);
  const auto [x, forces] = dense(s, effort, right, {1, 1}, std::vector<double>(9, 0.0));
  const Result<float> result =
      solved<float>(solve_constrained<n, Rows, Tree, float>, s, effort, right, {1, 1}, std::vector<float>(9, 0.f));
  EXPECT_LT(error(result.x, x), 1e-3);
  EXPECT_LT(error(result.forces, forces), 1e-3);
}

TEST(ConstraintKernels, DelassusMatrixIsJTimesTheInverseTimesJ) {
  using Rows = ConstraintRows<At16<3>, At21<6>, At12<3>>;
  const System s(shape<Rows>(), 2);
  const auto J = in<double>(s.J), U = in<double>(s.U), D = in<double>(s.D);
  std::vector<double> room(static_cast<size_t>(constraint_room(3, 6, 13, 12)), 7.0);
  Eigen::MatrixXd along(12, 12);
  delassus<n, Rows>(J.data(), U.data(), D.data(), room.data(), along.data());
  const Matrix expected = s.along();
  EXPECT_LT((along.cast<Real>() - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.cwiseAbs().maxCoeff());
}

// Six points of one limb of which rows say the same: rank 6 of 18, and of the rest what the others say.
TEST(ConstraintKernels, RedundantRowsChangeNoAcceleration) {
  using Rows = ConstraintRows<At12<6>, At12<6>, At21<6>>;
  System s(shape<Rows>(), 4);
  s.J.middleRows(6, 6) = s.J.topRows(6);  // twice the same
  const Vector effort = numbers(n, 1);
  Vector right = numbers(18, 2);
  right.segment(6, 6) = right.head(6);
  const std::vector<double> active{1, 1, 1}, none(18, 0.0);
  const auto [x, forces] = dense(s, effort, right, active, none);
  const Result<double> result = solved<double>(solve_constrained<n, Rows, Tree, double>, s, effort, right, active, none);
  EXPECT_LT(error(result.x, x), 1e-9);
  EXPECT_EQ(result.status.rank, 12);
  EXPECT_LT(result.status.least_pivot, 1e-6);
  EXPECT_GT(result.status.least_pivot, 0);
  EXPECT_LT(result.status.residual, 1e-6);
}

// Coordinates of two branches that a third one is interleaved with are shared one by one.
TEST(ConstraintKernels, PathsMayShareAnyNumberOfPieces) {
  using Rows = ConstraintRows<RowPath<3, 0, 2, 4, 6, 8, 10, 12, 14, 16>,
                              LoopPath<3, 3, 18, 18, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17>>;
  static_assert(Rows::shared.pieces[Rows::pair(0, 1)].count == 9);
  static_assert(Rows::shared.pieces[Rows::pair(0, 1)].b[8] == 16);
}

// Points of one body say six things, wherever they are and however little it weighs: no order of rows and no size of theirs
// makes more of it.
TEST(ConstraintKernels, PointsOfOneBodySaySixThings) {
  using Rows = ConstraintRows<At12<3>, At12<3>, At12<3>, At12<3>>;
  constexpr int all = Rows::first(Rows::count);
  for (unsigned seed = 1; seed < 60; ++seed) {
    System s(shape<Rows>(), seed);
    std::mt19937 engine(seed);
    const auto draw = [&](double size) { return std::uniform_real_distribution<double>(-size, size)(engine); };
    const double arm = std::pow(10, draw(1)), foot = std::pow(10, draw(1));
    Matrix twist = s.J.topRows(6);  // of the body
    twist.topRows(3) *= arm;
    for (int c = 0; c < Rows::count; ++c) {
      const Eigen::Matrix<Real, 3, 1> at(foot * draw(1), foot * draw(1), foot * draw(0.1));
      Matrix moves(3, 6);
      moves << 1, 0, 0, 0, at[2], -at[1], 0, 1, 0, -at[2], 0, at[0], 0, 0, 1, at[1], -at[0], 0;
      s.J.middleRows(3 * c, 3) = moves * twist;
    }
    const std::vector<double> active(static_cast<size_t>(Rows::count), 1), none(static_cast<size_t>(all), 0.0);
    const Vector effort = numbers(n, 1), right = s.J * numbers(n, 2);
    const Result<double> result = solved<double>(solve_constrained<n, Rows, Tree, double>, s, effort, right, active, none);
    EXPECT_EQ(result.status.rank, 6) << "seed " << seed;
    EXPECT_LT(result.status.least_pivot, 10 * all * Proximal<double>::mu) << "seed " << seed;
  }
}

// Two welds of rank three, of which the second says what the first says, and that ask for what cannot be: what comes closest,
// in terms of N. Few rows, and more.
template <class Rows>
void expect_closest() {
  constexpr int all = Rows::first(Rows::count);
  std::mt19937 engine(9);
  const auto drawn = [&](int rows, int columns) -> Matrix {
    return Matrix::NullaryExpr(rows, columns, [&] { return std::uniform_real_distribution<double>(-1, 1)(engine); });
  };
  for (unsigned seed = 1; seed < 6; ++seed) {
    System s(shape<Rows>(), seed);
    const Vector effort = numbers(n, 1), right = numbers(all, 2);
    const Matrix said = s.J.topRows(3);
    s.J.topRows(6) = drawn(6, 3) * said, s.J.middleRows(6, 6) = drawn(6, 3) * said;
    const Matrix inverse = s.M.inverse(), along = s.along();
    Vector scale(all);  // N^-1/2
    for (int r = 0; r < all; r += 3)
      scale.segment(r, 3).setConstant(
          1 / std::sqrt(along.diagonal().segment(r, 3).mean() + static_cast<Real>(least_share) * along.trace()));
    Eigen::CompleteOrthogonalDecomposition<Matrix> scaled(all, all);
    scaled.setThreshold(1e-12L);
    scaled.compute(scale.asDiagonal() * along * scale.asDiagonal());
    const Vector forces = scale.asDiagonal() * scaled.solve(scale.asDiagonal() * (right - s.J * inverse * effort));
    const Vector x = inverse * (effort + s.J.transpose() * forces);
    const std::vector<double> active(static_cast<size_t>(Rows::count), 1), none(static_cast<size_t>(all), 0.0);
    const Result<double> result = solved<double>(solve_constrained<n, Rows, Tree, double>, s, effort, right, active, none);
    EXPECT_LT(error(result.x, x), 1e-6) << all << " rows, seed " << seed;
    EXPECT_EQ(result.status.rank, all - 9) << all << " rows, seed " << seed;
    EXPECT_GT(result.status.residual, 0.01);
  }
}
TEST(ConstraintKernels, SingularBlocksThatSayTheSameComeClosest) {
#ifdef DALEMBERT_LONG_TESTS
  expect_closest<ConstraintRows<At12<6>, At12<6>>>();
#endif
  expect_closest<ConstraintRows<At12<6>, At12<6>, At21<6>>>();
}

// Rows that no joint moves, and that ask for what cannot be: no number is lost.
TEST(ConstraintKernels, RowsThatNothingMovesGiveNumbers) {
  using Rows = ConstraintRows<At12<6>, At21<6>>;
  System s(shape<Rows>(), 4);
  s.J.middleRows(6, 6).setZero();
  const Vector effort = numbers(n, 1), right = numbers(12, 2);
  const Result<double> result =
      solved<double>(solve_constrained<n, Rows, Tree, double>, s, effort, right, {1, 1}, std::vector<double>(12, 0.0));
  const auto [x, forces] = dense(s, effort, right, {1, 0}, std::vector<double>(12, 0.0));
  EXPECT_TRUE(result.forces.allFinite());
  EXPECT_LT(error(result.x, x), 1e-9);
  EXPECT_GT(result.status.residual, 0.1);
  EXPECT_EQ(result.status.rank, 6);
}

// Nor do rows of rounding alone hold what they do not touch: a slider along the plane that it shall not leave.
TEST(ConstraintKernels, RowsOfRoundingHoldNothing) {
  using Rows = ConstraintRows<At12<6>, At21<6>>;
  System s(shape<Rows>(), 4);
  const Vector effort = numbers(n, 1), right = Vector::Zero(12);
  const std::vector<double> none(12, 0.0);
  const Vector free = s.M.inverse() * effort;
  s.J *= 1e-16L;
  const Result<double> result = solved<double>(solve_constrained<n, Rows, Tree, double>, s, effort, right, {1, 1}, none);
  EXPECT_LT(error(result.x, free), 1e-11);
  EXPECT_EQ(result.forces.cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(result.status.rank, 0);
}

// What is left of the error along a direction that is a part s of what the others of its three rows are: of N there is mu N
// more.
TEST(ConstraintKernels, WhatIsNextToNothingIsGivenUp) {
  using Rows = ConstraintRows<At12<6>, At21<6>>;
  const Matrix turn = Eigen::Quaternion<Real>(0.3L, 0.5L, -0.2L, 0.7L).normalized().toRotationMatrix();
  for (const Real part : {1e-6L, 1e-7L, 1e-8L}) {
    System s(shape<Rows>(), 7);
    const Matrix lower = Eigen::LLT<Matrix>(s.along().topLeftCorner(6, 6)).matrixL();
    s.J.topRows(6) = lower.inverse() * s.J.topRows(6).eval();  // J M^-1 J' = 1
    s.J.topRows(3) =
        turn * Eigen::Matrix<Real, 3, 1>(1, 1, std::sqrt(part)).asDiagonal() * turn.transpose() * s.J.topRows(3).eval();
    Vector right = Vector::Zero(12);
    right.head(3) = turn.col(2);
    const std::vector<double> none(12, 0.0);
    const Result<double> result =
        solved<double>(solve_constrained<n, Rows, Tree, double>, s, Vector::Zero(n), right, {1, 0}, none);
    const Real held = Real(Proximal<double>::mu) * (2 + part) / 3, left = std::pow(held / (held + part), 3);
    EXPECT_NEAR(static_cast<double>(1 - turn.col(2).dot((s.J * result.x).head(3))), static_cast<double>(left),
                static_cast<double>(0.01L * left) + 1e-9)
        << static_cast<double>(part);
    EXPECT_NEAR(result.status.residual, static_cast<double>(left), 0.5 * static_cast<double>(left) + 1e-9);
  }
}

// Nothing of a constraint that does not act reaches any number but its own rows', which are zero.
TEST(ConstraintKernels, AMaskedConstraintChangesNothingByABit) {
  using Rows = ConstraintRows<At16<3>, At21<6>, At12<3>>;
  System s(shape<Rows>(), 5);
  const Vector effort = numbers(n, 1);
  Vector right = numbers(12, 2);
  std::vector<double> regularization(12, 0.01);
  const auto solve = [&](const std::vector<double>& active) {
    return solved<double>(solve_constrained<n, Rows, Tree, double>, s, effort, right, active, regularization);
  };
  const Result<double> before = solve({1, 0, 1});
  s.J.middleRows(3, 6) *= 3;
  right.segment(3, 6) *= 100;
  for (size_t r = 3; r < 9; ++r) regularization[r] = 55;
  const Result<double> after = solve({1, 0, 1});
  for (int i = 0; i < n; ++i) EXPECT_EQ(before.x[i], after.x[i]);
  for (int r = 0; r < 12; ++r) EXPECT_EQ(before.forces[r], after.forces[r]);
  EXPECT_EQ(before.status.residual, after.status.residual);
  EXPECT_EQ(after.status.rank, 6);
  // It is not so that nothing reaches them.
  EXPECT_GT((solve({1, 1, 1}).x - after.x).cwiseAbs().maxCoeff(), 1e-3);
}

// What respond() and those behind it make of a system: N, and derivatives for changes drawn.
struct Derived {
  Matrix N, of_forces, accelerations, forces;
};
template <class T>
struct Derivatives {
  using Respond = void (*)(const T* jacobian, const T* inverse, const T* active, const T* regularization, T* room,
                           T* projected);
  Respond respond, go_on;  // the latter with what solving has left
  ConstraintStatus<T> (*solve)(const T* jacobian, const T* factor, const T* pivots, const T* right, const T* active,
                               const T* regularization, T* room, T* forces, T* x, T* response);
  void (*of_forces)(const T* room, T* to);
  void (*accelerations)(int first, const T* changes, const T* room, T* to);
  void (*forces)(const T* efforts, const T* changes, const T* room, T* to);
  void (*turning)(const T* left, const T* right, const T* projected, const T* room, T* turning, T* accelerations, T* forces);
};
template <class T, class Rows, int more>
Derivatives<T> derivatives() {
  return {respond<n, Rows, true, false, T>, respond<n, Rows, true, true, T>,  solve_constrained<n, Rows, Tree, T>,
          response_of_forces<n, Rows, T>,   derive_accelerations<n, Rows, T>, derive_forces<n, Rows, T>,
          derive_turning<n, Rows, more, T>};
}
template <class T>
Derived derived(const Derivatives<T>& kernels, const System& s, const Matrix& efforts, const Matrix& changes,
                const Matrix& left, const Matrix& right, const std::vector<T>& active, const std::vector<T>& regularization,
                int first, bool solve_first) {
  const int m = s.shape.all(), stride = inverse_stride(n), more = static_cast<int>(left.rows());
  using Numbers = Dense<T>;
  const Numbers J = in<T>(s.J), e = in<T>(efforts), c = in<T>(changes), l = in<T>(left), r = in<T>(right);
  Numbers inverse = Numbers::Zero(stride, n + 7), projected = Numbers::Constant(stride, n + 7, T(7));
  inverse.topLeftCorner(n, n) = in<T>(s.M.inverse());
  std::vector<T> room(static_cast<size_t>(response_room(n, m)), T(7)),
      turning(static_cast<size_t>(turning_room(n, m, more)), T(7));
  if (solve_first) {
    const Numbers U = in<T>(s.U), D = in<T>(s.D);
    std::vector<T> own(static_cast<size_t>(constraint_room(s.shape.count, 6, n, m)), T(7)), f(static_cast<size_t>(m)),
        x(n, T(1)), b(static_cast<size_t>(m), T(2));
    kernels.solve(J.data(), U.data(), D.data(), b.data(), active.data(), regularization.data(), own.data(), f.data(), x.data(),
                  room.data());
  }
  (solve_first ? kernels.go_on : kernels.respond)(J.data(), inverse.data(), active.data(), regularization.data(), room.data(),
                                                  projected.data());
  Numbers of_forces(m, n), to = -projected.topLeftCorner(n, n) * e, forces = Numbers::Constant(m, n, T(7));
  to.leftCols(first).setConstant(T(7));  // not there yet
  kernels.of_forces(room.data(), of_forces.data());
  kernels.accelerations(first, c.data(), room.data(), to.data());
  kernels.forces(e.data(), c.data(), room.data(), forces.data());
  kernels.turning(l.data(), r.data(), projected.data(), room.data(), turning.data(), to.data(), forces.data());
  return {projected.topLeftCorner(n, n).template cast<Real>(), of_forces.template cast<Real>(), to.template cast<Real>(),
          forces.template cast<Real>()};
}

// −K⁻¹ of what the equations change by.
constexpr int more = 9;
template <class T>
void expect_derivatives(const Shape& shape, const Derivatives<T>& kernels, double tolerance) {
  const int count = shape.count, m = shape.all(), first = 3;
  for (unsigned seed = 1; seed < 4; ++seed) {
    const System s(shape, seed);
    std::mt19937 engine(seed + 10);
    const auto draw = [&] { return std::uniform_real_distribution<double>(-1, 1)(engine); };
    const auto drawn = [&](int rows) {
      Matrix x(rows, n);
      for (int k = 0; k < n; ++k)
        for (int r = 0; r < rows; ++r) x(r, k) = draw();
      return x;
    };
    Matrix efforts = drawn(n), changes = drawn(m);
    const Matrix left = drawn(more), right = drawn(more);
    efforts.leftCols(first).setZero();
    for (int c = 0; c < count; ++c)
      for (int k = 0; k < n; ++k)
        if (!shape.knows(c, k)) changes.col(k).segment(shape.first(c), shape.rows[c]).setZero();
    for (unsigned mask = 0; mask < (1u << count); ++mask) {
      std::vector<T> active, regularization;
      for (int c = 0; c < count; ++c) active.push_back((mask >> c) & 1u ? T(1) : T(0));
      for (int r = 0; r < m; ++r) regularization.push_back(mask % 2 == 0 ? T(0.01) * T(r + 1) : T(0));
      Matrix K = Matrix::Zero(n + m, n + m), right_side = Matrix::Zero(n + m, n), of_tau = right_side;
      K.topLeftCorner(n, n) = s.M;
      for (int c = 0; c < count; ++c)
        for (int r = shape.first(c); r < shape.first(c + 1); ++r) {
          K(n + r, n + r) = active[static_cast<size_t>(c)] > T(0) ? -Real(regularization[static_cast<size_t>(r)]) : -1;
          if (!(active[static_cast<size_t>(c)] > T(0))) continue;
          K.row(n + r).head(n) = s.J.row(r);
          K.col(n + r).head(n) = s.J.row(r).transpose();
          right_side.row(n + r) = -changes.row(r);
        }
      right_side.topRows(n) = -efforts - left.transpose() * right;
      of_tau.topRows(n).setIdentity();
      // M d(dv) − Jᵀ df = −de: df with its sign turned.
      const Eigen::FullPivLU<Matrix> solve(K);
      const Matrix solution = solve.solve(right_side), response = solve.solve(of_tau);
      const auto near = [&](const Matrix& a, const Matrix& b) {
        EXPECT_LT((a - b).cwiseAbs().maxCoeff(), tolerance * std::max<Real>(b.cwiseAbs().maxCoeff(), 1));
      };
      for (const bool solve_first : {false, true}) {
        SCOPED_TRACE(testing::Message() << "seed " << seed << ", mask " << mask << (solve_first ? ", solved first" : ""));
        const auto result = derived<T>(kernels, s, efforts, changes, left, right, active, regularization, first, solve_first);
        near(result.N, response.topRows(n));
        near(result.of_forces, -response.bottomRows(m));
        near(result.accelerations, solution.topRows(n));
        near(result.forces, -solution.bottomRows(m));
        for (int c = 0; c < count; ++c)
          if (!(active[static_cast<size_t>(c)] > T(0))) {
            EXPECT_EQ(result.forces.middleRows(shape.first(c), shape.rows[c]).cwiseAbs().maxCoeff(), 0);
          }
      }
    }
  }
}

template <class T, class Rows>
void expect_derivatives(double tolerance) {
  expect_derivatives<T>(shape<Rows>(), derivatives<T, Rows, more>(), tolerance);
}

TEST(ConstraintKernels, DerivativesAreWhatDenseAlgebraSays) {
  expect_derivatives<double, ConstraintRows<At12<3>, From12To16<5, 3>, AtBase<6>>>(1e-8);
#ifdef DALEMBERT_LONG_TESTS
  expect_derivatives<float, ConstraintRows<At12<3>, At21<3>>>(1e-2);
#endif
}

// Rows that say the same: d(dv) is what it is without those that say it again, for changes that do so, too.
TEST(ConstraintKernels, RedundantRowsChangeNoDerivative) {
  using Twice = ConstraintRows<At12<6>, At12<6>, At21<6>>;
  System s(shape<Twice>(), 4);
  s.J.middleRows(6, 6) = s.J.topRows(6);
  std::mt19937 engine(3);
  Matrix efforts = Matrix::Zero(n, n), changes = Matrix::Zero(18, n);
  const auto draw = [&] { return std::uniform_real_distribution<double>(-1, 1)(engine); };
  for (int k = 0; k < n; ++k) {
    for (int i = 0; i < n; ++i) efforts(i, k) = draw();
    for (int r = 0; r < 18; ++r) changes(r, k) = draw();
  }
  for (int k = 13; k < 17; ++k) changes.col(k).setZero();
  for (int k = 6; k < 13; ++k) changes.col(k).tail(6).setZero();
  for (int k = 17; k < n; ++k) changes.col(k).head(12).setZero();
  changes.middleRows(6, 6) = changes.topRows(6);
  const Matrix none = Matrix::Zero(1, n);
  const std::vector<double> zeros(18, 0.0);
  const auto all = derived<double>(derivatives<double, Twice, 1>(), s, efforts, changes, none, none, {1, 1, 1}, zeros, 0, true),
             once =
                 derived<double>(derivatives<double, Twice, 1>(), s, efforts, changes, none, none, {1, 0, 1}, zeros, 0, true);
  EXPECT_LT((all.accelerations - once.accelerations).cwiseAbs().maxCoeff(), 1e-11 * once.accelerations.cwiseAbs().maxCoeff());
  EXPECT_LT((all.N - once.N).cwiseAbs().maxCoeff(), 1e-11 * once.N.cwiseAbs().maxCoeff());
  // They share their forces.
  EXPECT_LT((all.forces.topRows(6) - once.forces.topRows(6) / 2).cwiseAbs().maxCoeff(),
            1e-4 * once.forces.cwiseAbs().maxCoeff());
}

}  // namespace
}  // namespace dalembert
