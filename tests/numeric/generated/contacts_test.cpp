// Generated code of robots with contacts: what it solves for against dense algebra on its own M, bias and J, and what is given
// at run time.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstring>
#include <dalembert/integrators/motion.hpp>
#include <random>

#include "heap_count.hpp"
#include "standing_biped/c_api.h"
#include "standing_biped/dynamics.hpp"
#include "standing_quadruped/dynamics.hpp"

struct standing_biped_workspace : standing_biped::Workspace {};  // as in c_api.cpp

namespace {

// C knows the same places.
static_assert(standing_biped_q_size == standing_biped::nq && standing_biped_v_size == standing_biped::nv &&
              standing_biped_constraint_rows == 12);
static_assert(standing_biped_q_index_right_5_toe_joint == q_index(standing_biped::Joint::right_5_toe_joint) &&
              standing_biped_v_index_right_5_toe_joint == v_index(standing_biped::Joint::right_5_toe_joint));

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

double largest(const Matrix& m) { return m.cwiseAbs().maxCoeff<Eigen::PropagateNaN>(); }

struct State {
  Vector q, v, tau;

  State(int nq, int nv, unsigned seed) : q(nq), v(nv), tau(nv) {
    std::mt19937 engine(seed);
    const auto draw = [&](double size) { return std::uniform_real_distribution<double>(-size, size)(engine); };
    for (double& x : q) x = draw(1);
    for (double& x : v) x = draw(1);
    for (double& x : tau) x = draw(30);
    q.segment<4>(3).normalize();
  }
};

// Everything that a robot's two functions give.
struct Results {
  Matrix M, J, along;
  Vector h, bias, acceleration, forces, after;
};

#define RESULTS_OF(robot)                                                                                                      \
  Results results_of(const State& s, robot::Workspace& w) {                                                                    \
    robot::evaluate(s.q.data(), s.v.data(), w);                                                                                \
    robot::forward_dynamics(s.q.data(), s.v.data(), s.tau.data(), w);                                                          \
    return {robot::mass_matrix(w),     robot::constraint_jacobian(w),          robot::delassus_matrix(w),   robot::bias(w),    \
            robot::constraint_bias(w), robot::constrained_forward_dynamics(w), robot::constraint_forces(w), robot::impact(w)}; \
  }
RESULTS_OF(standing_biped)
RESULTS_OF(standing_quadruped)
#undef RESULTS_OF

// A column for every column of v̇'s derivative and that of the forces below it.
struct Motion {
  Vector both;
  Matrix by_q, by_v, by_tau;
};
#define MOTION_OF(robot)                                                                             \
  Motion motion_of(const State& s, robot::Workspace& w) {                                            \
    robot::forward_dynamics(s.q.data(), s.v.data(), s.tau.data(), w);                                \
    const auto stacked = [](const Matrix& a, const Matrix& b) {                                      \
      Matrix all(a.rows() + b.rows(), a.cols());                                                     \
      all << a, b;                                                                                   \
      return all;                                                                                    \
    };                                                                                               \
    return {stacked(robot::constrained_forward_dynamics(w), robot::constraint_forces(w)),            \
            stacked(robot::constrained_forward_dynamics_dq(w), robot::constraint_forces_dq(w)),      \
            stacked(robot::constrained_forward_dynamics_dv(w), robot::constraint_forces_dv(w)),      \
            stacked(robot::constrained_forward_dynamics_dtau(w), robot::constraint_forces_dtau(w))}; \
  }
MOTION_OF(standing_biped)
MOTION_OF(standing_quadruped)
#undef MOTION_OF

// Against differences of the sixth order, exact by v and tau but for rounding; what is far smaller than the rest of its matrix
// is compared with that.
template <class Workspace>
void expect_derivatives(const State& s, Workspace& w) {
  const Motion here = motion_of(s, w);
  const Eigen::Index n = s.v.size();
  Matrix by_q(here.both.size(), n), by_v = by_q, by_tau = by_q;
  const auto difference = [&](const auto& moved, double size) -> Vector {
    Vector d[3];
    const double steps[] = {size, size / 2, size / 4};
    for (int i = 0; i < 3; ++i)
      d[i] = (motion_of(moved(steps[i]), w).both - motion_of(moved(-steps[i]), w).both) / (2 * steps[i]);
    const Vector one = (4 * d[1] - d[0]) / 3, two = (4 * d[2] - d[1]) / 3;
    return (16 * two - one) / 15;
  };
  for (Eigen::Index k = 0; k < n; ++k) {
    const Vector unit = Vector::Unit(n, k);
    by_q.col(k) = difference(
        [&](double h) {
          State moved = s;
          dalembert::integrators::move(s.q, Vector(h * unit), moved.q);
          return moved;
        },
        0.02);
    by_v.col(k) = difference(
        [&](double h) {
          State moved = s;
          moved.v += h * unit;
          return moved;
        },
        1);
    by_tau.col(k) = difference(
        [&](double h) {
          State moved = s;
          moved.tau += h * unit;
          return moved;
        },
        10);
  }
  const auto near = [&](const Matrix& ours, const Matrix& expected, double tolerance) {
    EXPECT_LT(largest(ours.topRows(n) - expected.topRows(n)), tolerance * largest(expected.topRows(n)));
    EXPECT_LT(largest(ours.bottomRows(ours.rows() - n) - expected.bottomRows(ours.rows() - n)),
              tolerance * largest(expected.bottomRows(ours.rows() - n)));
  };
  near(here.by_q, by_q, 5e-7);
  near(here.by_v, by_v, 1e-8);
  near(here.by_tau, by_tau, 1e-8);
}

template <class Workspace>
void expect_identities(int nq, int nv) {
  for (unsigned seed = 1; seed < 6; ++seed) {
    SCOPED_TRACE(seed);
    Workspace w;
    const State s(nq, nv, seed);
    const Results r = results_of(s, w);
    const Matrix inverse = r.M.inverse(), along = r.J * inverse * r.J.transpose();
    EXPECT_LT(largest(r.along - along), 1e-10 * largest(along));
    EXPECT_LT(largest(r.M * r.acceleration + r.h - s.tau - r.J.transpose() * r.forces),
              1e-10 * largest(r.J.transpose() * r.forces));
    EXPECT_LT(largest(r.J * r.acceleration + r.bias), 1e-9 * largest(r.bias));
    EXPECT_LT(largest(r.J * r.after), 1e-8 * largest(r.J * s.v));
    EXPECT_EQ(w.forward_dynamics_constraint_status.rank, r.J.rows());
    EXPECT_LT(w.forward_dynamics_constraint_status.residual, 1e-8 * largest(r.bias));
    EXPECT_GT(w.forward_dynamics_constraint_status.least_pivot, 1e-6);
    // What an impact takes off is what the rows carry.
    const Vector impulses = along.ldlt().solve(-r.J * s.v);
    EXPECT_LT(largest(r.M * (r.after - s.v) - r.J.transpose() * impulses), 1e-8 * largest(r.J.transpose() * impulses));
  }
}

TEST(Contacts, OfABipedsFeetKeepThemStill) {
  expect_identities<standing_biped::Workspace>(standing_biped::nq, standing_biped::nv);
}
TEST(Contacts, OfAQuadrupedsFeetKeepThemStill) {
  expect_identities<standing_quadruped::Workspace>(standing_quadruped::nq, standing_quadruped::nv);
}

TEST(Contacts, ThatDoNotActChangeNothingByABit) {
  using namespace standing_quadruped;
  const State s(nq, nv, 3);
  Workspace w;
  w.contact_front_right.active = false;
  const Results before = results_of(s, w);
  w.contact_front_right.kp = 1e6;
  w.contact_front_right.kd = 1e4;
  w.contact_front_right.restitution = 1;
  w.contact_front_right.anchor[1] = 7;
  w.contact_front_right.regularization[2] = 3;
  const Results after = results_of(s, w);
  for (int k = 0; k < nv; ++k) {
    EXPECT_EQ(before.acceleration[k], after.acceleration[k]);
    EXPECT_EQ(before.after[k], after.after[k]);
  }
  for (Eigen::Index r = 0; r < before.forces.size(); ++r) EXPECT_EQ(before.forces[r], after.forces[r]);
  Contact& off = w.contact_front_right;
  off.kp = off.kd = off.restitution = off.anchor[0] = off.anchor[6] = off.regularization[0] = std::nan("");
  const Results beside_nan = results_of(s, w);
  EXPECT_TRUE(beside_nan.acceleration == after.acceleration && beside_nan.after == after.after &&
              beside_nan.forces == after.forces);
  off = {};
  off.active = false;
  EXPECT_EQ(largest(after.forces.segment(3, 3)), 0);
  EXPECT_EQ(w.forward_dynamics_constraint_status.rank, 9);
  // It is what the other rows alone make.
  Matrix J(9, nv);
  J << before.J.topRows(3), before.J.bottomRows(6);
  Vector bias(9);
  bias << before.bias.head(3), before.bias.tail(6);
  const Matrix inverse = before.M.inverse();
  const Vector free = inverse * (s.tau - before.h), forces = (J * inverse * J.transpose()).ldlt().solve(-bias - J * free),
               expected = free + inverse * J.transpose() * forces;
  EXPECT_LT(largest(after.acceleration - expected), 1e-8 * largest(expected));
  w.contact_front_right.active = true;
  EXPECT_GT(largest(results_of(s, w).acceleration - after.acceleration), 1);  // so that acting matters
}

// The foot where it stands, its anchor beside it: the rows are drawn along what lies between.
TEST(Contacts, AreDrawnToTheirAnchorsAndDamped) {
  using namespace standing_biped;
  const State s(nq, nv, 4);
  Workspace w;
  const Results still = results_of(s, w);
  const Matrix pose = pose_left_5_toe(w);
  const Eigen::Matrix3d axes = pose.leftCols(3);
  const Eigen::Vector3d away(0.3, -0.2, 0.1), turned = Eigen::Vector3d(2, -1, 2) / 3;
  const double angle = 0.2;
  // e = x - x0 is `away`; e of the axes is sin(angle) about `turned`.
  const Eigen::Quaterniond anchor(Eigen::AngleAxisd(-angle, turned) * axes);
  const Eigen::Vector3d place = pose.col(3) - away;
  Contact& foot = w.contact_left_5_toe;
  for (int i = 0; i < 3; ++i) foot.anchor[i] = place[i];
  foot.anchor[3] = anchor.x(), foot.anchor[4] = anchor.y(), foot.anchor[5] = anchor.z(), foot.anchor[6] = anchor.w();
  foot.kp = 100;
  foot.kd = 20;
  const Results drawn = results_of(s, w);
  Vector expected = -still.bias;
  expected.head(3) -= 100 * away;
  expected.segment(3, 3) -= 100 * std::sin(angle) * turned;
  expected.head(6) -= 20 * (still.J * s.v).head(6);
  EXPECT_LT(largest(drawn.J * drawn.acceleration - expected), 1e-8 * largest(expected));
}

TEST(Contacts, GiveWayAsTheyAreRegularized) {
  using namespace standing_biped;
  const State s(nq, nv, 5);
  Workspace w;
  Vector R(12);
  for (int i = 0; i < 6; ++i) {
    w.contact_left_5_toe.regularization[i] = R[i] = 0.1 * (1 + i);
    w.contact_heel.regularization[i] = R[6 + i] = 0.05 * (2 + i);
  }
  const Results r = results_of(s, w);
  const Vector missed = r.J * r.acceleration + r.bias + R.cwiseProduct(r.forces);
  EXPECT_LT(largest(missed), 1e-8 * largest(r.bias));
}

TEST(Contacts, BounceByTheirRestitution) {
  using namespace standing_quadruped;
  const State s(nq, nv, 6);
  Workspace w;
  w.contact_front_right.restitution = 0.5;
  const Results r = results_of(s, w);
  Vector expected = Vector::Zero(12);
  expected.segment(3, 3) = -0.5 * (r.J * s.v).segment(3, 3);
  EXPECT_LT(largest(r.J * r.after - expected), 1e-9 * largest(r.J * s.v));
}

TEST(Contacts, OfABipedAreDifferentiatedAsTheyAreSet) {
  using namespace standing_biped;
  const State s(nq, nv, 8);
  Workspace w;
  expect_derivatives(s, w);
  const double anchor[] = {0.1, -0.2, 0.3, 0.36, -0.48, 0.64, 0.48};
  for (Contact* contact : {&w.contact_left_5_toe, &w.contact_heel}) {
    std::copy(std::begin(anchor), std::end(anchor), contact->anchor);
    contact->kp = 30;
    contact->kd = 6;
  }
  for (int i = 0; i < 6; ++i) w.contact_heel.regularization[i] = 0.02 * (1 + i);
  expect_derivatives(s, w);
  w.contact_left_5_toe.active = false;
  expect_derivatives(s, w);
}

TEST(Contacts, OfAQuadrupedAreDifferentiatedAsTheyAreSet) {
  using namespace standing_quadruped;
  const State s(nq, nv, 9);
  Workspace w;
  expect_derivatives(s, w);
  w.contact_hind_left.kp = 30;
  w.contact_hind_left.kd = w.contact_front_right.kd = 6;
  w.contact_front_right.regularization[1] = 0.1;
  w.contact_hind_right_3_knee.active = false;
  const Motion before = motion_of(s, w);
  expect_derivatives(s, w);
  // Of one that does not act nothing reaches the others by a bit.
  w.contact_hind_right_3_knee.kp = 1e6;
  w.contact_hind_right_3_knee.regularization[0] = 7;
  Contact& off = w.contact_hind_right_3_knee;
  const Motion beside_large = motion_of(s, w);
  EXPECT_TRUE(before.by_q == beside_large.by_q && before.by_v == beside_large.by_v && before.by_tau == beside_large.by_tau);
  off.kp = off.kd = off.anchor[0] = off.anchor[6] = off.regularization[0] = std::nan("");
  const Motion after = motion_of(s, w);
  EXPECT_TRUE(before.by_q == after.by_q && before.by_v == after.by_v && before.by_tau == after.by_tau);
  EXPECT_EQ(largest(after.by_q.bottomRows(3)) + largest(after.by_v.bottomRows(3)) + largest(after.by_tau.bottomRows(3)), 0);
}

TEST(Contacts, AreSetInCAndAllocateNothing) {
  standing_biped_workspace* const w = standing_biped_create();
  ASSERT_NE(w, nullptr);
  const State s(standing_biped::nq, standing_biped::nv, 7);
  const double anchor[7] = {1, 2, 3, 0, 0, 0, 1}, regularization[6] = {1, 2, 3, 4, 5, 6};
  standing_biped_set_contact_heel(0, 10, 2, 0.5, anchor, regularization, w);
  EXPECT_FALSE(w->contact_heel.active);
  EXPECT_EQ(w->contact_heel.kp, 10);
  EXPECT_EQ(w->contact_heel.kd, 2);
  EXPECT_EQ(w->contact_heel.restitution, 0.5);
  EXPECT_EQ(std::memcmp(w->contact_heel.anchor, anchor, sizeof anchor), 0);
  EXPECT_EQ(std::memcmp(w->contact_heel.regularization, regularization, sizeof regularization), 0);
  standing_biped_set_contact_heel(1, 0, 0, 0, nullptr, nullptr, w);
  EXPECT_EQ(w->contact_heel.anchor[1], 2);
  const std::uint64_t before = dalembert::testing::heap_allocations();
  standing_biped_forward_dynamics(s.q.data(), s.v.data(), s.tau.data(), w);
  standing_biped_evaluate(s.q.data(), s.v.data(), w);
  EXPECT_EQ(dalembert::testing::heap_allocations(), before);
  double pivot = 0;
  int rank = 0;
  EXPECT_LT(standing_biped_forward_dynamics_constraint_status(&pivot, &rank, w), 1e-6);
  EXPECT_EQ(rank, 12);
  EXPECT_GT(pivot, 0);
  standing_biped_destroy(w);
}

}  // namespace
