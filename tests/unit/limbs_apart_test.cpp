// Points of limbs that have the base alone in common, which are solved for limb by limb, against dense algebra.
#include <gtest/gtest.h>

#include "constraint_systems.hpp"

namespace dalembert {
namespace {

// A base of six coordinates, and four limbs of three to five on it.
using Legs = ChainTree<ChainBelow<0, 6>, ChainBelow<6, 3, 0, 6>, ChainBelow<9, 4, 0, 6>, ChainBelow<13, 5, 0, 6>,
                       ChainBelow<18, 4, 0, 6>>;
constexpr int above_legs[n] = {-1, 0, 1, 2, 3, 4, 5, 6, 7, 5, 9, 10, 11, 5, 13, 14, 15, 16, 5, 18, 19, 20};
using BesideEachOther = InSlots<0, 4, 8, 1, 5, 9, 13, 2, 6, 10, 14, 18, 3, 7, 11, 15>;
using OneAtATime = InSlots<0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15>;

using FirstFoot = RowPath<3, 0, 1, 2, 3, 4, 5, 6, 7, 8>;
using SecondFoot = RowPath<3, 0, 1, 2, 3, 4, 5, 9, 10, 11, 12>;
using ThirdKnee = RowPath<3, 0, 1, 2, 3, 4, 5, 13, 14, 15, 16>;  // of a limb that goes on
using ThirdHip = RowPath<3, 0, 1, 2, 3, 4, 5, 13, 14>;           // with fewer joints than rows
using FourthFoot = RowPath<3, 0, 1, 2, 3, 4, 5, 18, 19, 20, 21>;
using All = ConstraintRows<FirstFoot, SecondFoot, ThirdKnee, FourthFoot>;
using Crossed = ConstraintRows<ThirdKnee, FirstFoot, FourthFoot, SecondFoot>;
using Three = ConstraintRows<FourthFoot, FirstFoot, ThirdKnee>;
using WithHip = ConstraintRows<FirstFoot, SecondFoot, ThirdHip, FourthFoot>;

// Five limbs of three, and a joint alone.
using Insect = ChainTree<ChainBelow<0, 6>, ChainBelow<6, 3, 0, 6>, ChainBelow<9, 3, 0, 6>, ChainBelow<12, 3, 0, 6>,
                         ChainBelow<15, 3, 0, 6>, ChainBelow<18, 3, 0, 6>, ChainBelow<21, 1, 0, 6>>;
constexpr int above_insect[n] = {-1, 0, 1, 2, 3, 4, 5, 6, 7, 5, 9, 10, 5, 12, 13, 5, 15, 16, 5, 18, 19, 5};
using FiveBeside = InSlots<0, 8, 16, 1, 9, 17, 2, 10, 18, 3, 11, 19, 4, 12, 20, 5>;
using Five = ConstraintRows<RowPath<3, 0, 1, 2, 3, 4, 5, 15, 16, 17>, RowPath<3, 0, 1, 2, 3, 4, 5, 6, 7, 8>,
                            RowPath<3, 0, 1, 2, 3, 4, 5, 12, 13, 14>, RowPath<3, 0, 1, 2, 3, 4, 5, 18, 19, 20>,
                            RowPath<3, 0, 1, 2, 3, 4, 5, 9, 10, 11>>;

template <class Rows, class Where>
constexpr bool by_limb() {
  using Slots = decltype(std::declval<const Where&>().limbs());
  return constraint_detail::are_points_of_limbs_apart<Rows, Slots>();
}
static_assert(by_limb<All, BesideEachOther>() && by_limb<Crossed, BesideEachOther>() && by_limb<Three, BesideEachOther>() &&
                  by_limb<Five, FiveBeside>(),
              "registers of eight hold a number of each");
static_assert(!by_limb<WithHip, BesideEachOther>() && !by_limb<All, OneAtATime>() && !by_limb<All, InArrays>(),
              "these take all rows together");

template <class Rows, class Where, class Tree = Legs>
void expect_dense(const Limbs& limbs, const System& s, double tolerance) {
  const int all = s.shape.all();
  const Vector effort = numbers(n, 1), right = numbers(all, 2), start = (s.U * s.D.asDiagonal()).inverse() * effort;
  const auto wrenches = in<double>(limbs.wrenches), b = in<double>(right);
  std::vector<double> room(static_cast<size_t>(constraint_room(s.shape.count, 3, n, all)), 7.0);
  const Where numbers_of_limbs(limbs, s.D);
  const auto where = numbers_of_limbs.limbs();
  Eigen::MatrixXd along(all, all);
  delassus_by_limbs<n, Rows>(where, wrenches.data(), room.data(), along.data());
  EXPECT_LT((along.cast<Real>() - s.along()).cwiseAbs().maxCoeff(), 1e-12 * s.along().cwiseAbs().maxCoeff());
  EXPECT_EQ(along, along.transpose());
  for (unsigned mask = 0; mask < (1u << s.shape.count); ++mask)
    for (const double gives_way : {0.0, 0.01}) {
      SCOPED_TRACE(testing::Message() << "mask " << mask << ", R " << gives_way);
      std::vector<double> active, regularization;
      for (int c = 0; c < s.shape.count; ++c) active.push_back((mask >> c) & 1u ? 1 : 0);
      for (int r = 0; r < all; ++r) regularization.push_back(gives_way * r);
      const auto [expected, forces] = dense(s, effort, right, active, regularization);
      Eigen::VectorXd x = start.cast<double>(), f(all), v = Eigen::VectorXd::Ones(n), impulses(all);
      const auto status = solve_constrained_by_limbs<n, Rows, Tree>(where, wrenches.data(), b.data(), active.data(),
                                                                    regularization.data(), room.data(), f.data(), x.data());
      EXPECT_LT(error(x.cast<Real>(), expected), tolerance);
      EXPECT_LE((f.cast<Real>() - forces).cwiseAbs().maxCoeff(), tolerance * forces.cwiseAbs().maxCoeff());
      EXPECT_EQ(status.rank, 3 * std::count(active.begin(), active.end(), 1.0));
      EXPECT_LT(status.residual, tolerance);
      for (int r = 0; r < all; ++r) EXPECT_TRUE(active[static_cast<size_t>(r / 3)] > 0 || f[r] == 0);
      solve_impact_by_limbs<n, Rows, Tree>(where, wrenches.data(), b.data(), active.data(), regularization.data(), room.data(),
                                           impulses.data(), v.data());
      const Vector after = Vector::Ones(n) + dense(s, Vector::Zero(n), right, active, regularization).first;
      EXPECT_LT(error(v.cast<Real>(), after), tolerance);
    }
}
template <class Rows, class Where, class Tree = Legs>
void expect_dense(const int* above = above_legs) {
  for (unsigned seed = 1; seed < 4; ++seed) {
    System s(shape_of<Rows>(above), seed);
    const Limbs limbs(s, seed);
    expect_dense<Rows, Where, Tree>(limbs, s, 1e-10);
  }
}
TEST(LimbsApart, FeetAreWhatDenseAlgebraSays) { expect_dense<All, BesideEachOther>(); }
TEST(LimbsApart, FeetInAnyOrderAre) { expect_dense<Crossed, BesideEachOther>(); }
TEST(LimbsApart, FiveAre) { expect_dense<Five, FiveBeside, Insect>(above_insect); }
TEST(LimbsApart, ThreeOfFourAre) { expect_dense<Three, BesideEachOther>(); }
TEST(LimbsApart, ALimbWithFewJointsIs) { expect_dense<WithHip, BesideEachOther>(); }

// What no joint of its limb moves along a row, as along a straight knee, or hardly, the base does: the limb's own matrix is
// singular, and all rows together are not.
TEST(LimbsApart, WhatTheBaseAloneMovesIs) {
  for (const double bent : {0.0, 1e-12, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2}) {
    SCOPED_TRACE(bent);
    System s(shape_of<All>(above_legs), 2);
    Limbs limbs(s, 2);
    for (const int c : {0, 1}) {
      const int first = All::paths[c][6], joints = All::lengths[c] - 6;
      const Matrix axes = limbs.joint.middleCols(first, joints);
      const Vector row = limbs.wrenches.row(3 * c).transpose();
      const Vector felt = axes * (axes.transpose() * axes).inverse() * (axes.transpose() * row);
      limbs.wrenches.row(3 * c) = (row - (1 - bent) * felt).cast<double>().cast<Real>().transpose();
      for (int k = first; k < first + joints; ++k) s.J(3 * c, k) = limbs.wrenches.row(3 * c).dot(limbs.joint.col(k));
      for (int k = 0; k < 6; ++k) s.J(3 * c, k) = limbs.wrenches(3 * c, k);
    }
    expect_dense<All, BesideEachOther>(limbs, s, 1e-10);
  }
}

// Feet that say the same twice: one force is shared, and rank and pivot tell.
TEST(LimbsApart, RowsThatSayTheSameAreTold) {
  System s(shape_of<All>(above_legs), 3);
  Limbs limbs(s, 3);
  limbs.wrenches.row(1) = limbs.wrenches.row(0);
  s.J.row(1) = s.J.row(0);
  const int all = s.shape.all();
  Vector right = numbers(all, 2);
  right[1] = right[0];
  const Vector effort = numbers(n, 1), start = (s.U * s.D.asDiagonal()).inverse() * effort;
  const auto wrenches = in<double>(limbs.wrenches), b = in<double>(right);
  std::vector<double> room(static_cast<size_t>(constraint_room(s.shape.count, 3, n, all)), 7.0), active(4, 1.0), none(12, 0.0);
  const BesideEachOther numbers_of_limbs(limbs, s.D);
  Eigen::VectorXd x = start.cast<double>(), f(all);
  const auto status = solve_constrained_by_limbs<n, All, Legs>(numbers_of_limbs.limbs(), wrenches.data(), b.data(),
                                                               active.data(), none.data(), room.data(), f.data(), x.data());
  const auto [expected, forces] = dense(s, effort, right, active, none);
  EXPECT_LT(error(x.cast<Real>(), expected), 1e-10);
  EXPECT_NEAR(f[0], f[1], 1e-6 * f.cwiseAbs().maxCoeff());
  EXPECT_EQ(status.rank, 11);
  EXPECT_LT(status.least_pivot, 1e-7);
}

// A negative regularization is told, of what acts.
TEST(LimbsApart, NegativeRegularizationIsTold) {
  System s(shape_of<All>(above_legs), 3);
  const Limbs limbs(s, 3);
  const int all = s.shape.all();
  const auto wrenches = in<double>(limbs.wrenches), b = in<double>(numbers(all, 2));
  const Eigen::VectorXd start = ((s.U * s.D.asDiagonal()).inverse() * numbers(n, 1)).cast<double>();
  const BesideEachOther numbers_of_limbs(limbs, s.D);
  for (const int row : {0, 7, 11})
    for (const double given : {-1e-3, 1e-3})
      for (const double acts : {0.0, 1.0}) {
        std::vector<double> room(static_cast<size_t>(constraint_room(s.shape.count, 3, n, all))), active(4, 1.0), R(12, 0.01);
        R[static_cast<size_t>(row)] = given, active[static_cast<size_t>(row / 3)] = acts;
        Eigen::VectorXd x = start, f(all);
        const auto status = solve_constrained_by_limbs<n, All, Legs>(numbers_of_limbs.limbs(), wrenches.data(), b.data(),
                                                                     active.data(), R.data(), room.data(), f.data(), x.data());
        EXPECT_EQ(status.least_pivot == -1, given < 0 && acts > 0) << row << ": " << given << ", " << acts;
      }
}

// What rows along the world's axes bear in inverse dynamics: a limb in each lane, against their wrenches on the base.
template <class Rows>
void expect_support() {
  using Slots = decltype(std::declval<const BesideEachOther&>().limbs());
  static_assert(constraint_detail::limbs_beside<Rows, Slots>().slot >= 0, "registers of eight hold a number of each");
  expect_support_at_points<Rows, BesideEachOther>(above_legs);
}
TEST(LimbsApart, SupportAtFeetIsWhatTheirWrenchesGive) { expect_support<All>(); }
TEST(LimbsApart, SupportAtThreeFeetIs) { expect_support<Three>(); }
TEST(LimbsApart, SupportAtSolesIs) {
  expect_support<
      ConstraintRows<RowPath<6, 0, 1, 2, 3, 4, 5, 18, 19, 20, 21>, RowPath<6, 0, 1, 2, 3, 4, 5, 13, 14, 15, 16, 17>>>();
}

// Numbers that are none are not forces: the status has them.
TEST(LimbsApart, WhatIsNoNumberIsTold) {
  System s(shape_of<All>(above_legs), 1);
  const Limbs limbs(s, 1);
  const auto wrenches = in<double>(limbs.wrenches);
  std::vector<double> room(static_cast<size_t>(constraint_room(4, 3, n, 12)), 7.0), active(4, 1.0), none(12, 0.0), b(12, 1.0);
  b[4] = std::nan("");
  const BesideEachOther numbers_of_limbs(limbs, s.D);
  Eigen::VectorXd x = Eigen::VectorXd::Ones(n), f(12);
  const auto status = solve_constrained_by_limbs<n, All, Legs>(numbers_of_limbs.limbs(), wrenches.data(), b.data(),
                                                               active.data(), none.data(), room.data(), f.data(), x.data());
  EXPECT_TRUE(std::isnan(status.residual));
}

}  // namespace
}  // namespace dalembert
