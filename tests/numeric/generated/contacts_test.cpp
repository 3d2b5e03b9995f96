// Generated code of robots with contacts: what it solves for against dense algebra on its own M, bias and J, and what is given
// at run time.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstring>
#include <random>

#include "heap_count.hpp"
#include "standing_biped/c_api.h"
#include "standing_biped/dynamics.hpp"
#include "standing_quadruped/dynamics.hpp"

struct standing_biped_workspace : standing_biped::Workspace {};  // as in c_api.cpp

namespace {

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
    EXPECT_LT(largest(r.J * r.acceleration + r.bias), 1e-8 * largest(r.bias));
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
