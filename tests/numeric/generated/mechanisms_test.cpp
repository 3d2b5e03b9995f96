// Generated code of published mechanisms with loops: the values that others found, energy and what holds loops together over
// seconds, with and without stabilisation.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "andrews/dynamics.hpp"
#include "ankle/dynamics.hpp"
#include "bricard/dynamics.hpp"
#include "four_bars/dynamics.hpp"
#include "heap_count.hpp"
#include "slider_crank/c_api.h"
#include "slider_crank/dynamics.hpp"
#include "slider_crank_embedded/c_api.h"
#include "slider_crank_embedded/dynamics.hpp"

struct slider_crank_workspace : slider_crank::Workspace {};  // as in c_api.cpp
struct slider_crank_embedded_workspace : slider_crank_embedded::Workspace {};

namespace {

// C knows the same places, of independent joints.
static_assert(slider_crank_embedded_q_size == slider_crank_embedded::nq &&
              slider_crank_embedded_v_size == slider_crank_embedded::nv &&
              slider_crank_embedded_q_index_crank_turn == q_index(slider_crank_embedded::Joint::crank_turn) &&
              slider_crank_embedded_v_index_crank_turn == v_index(slider_crank_embedded::Joint::crank_turn));

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

double largest(const Matrix& m) { return m.cwiseAbs().maxCoeff<Eigen::PropagateNaN>(); }

// Steps of Runge and Kutta's: acceleration(q, v) gives v̇. After each: seen(q, v).
template <class Acceleration, class Seen>
void integrate(Vector& q, Vector& v, double step, int steps, const Acceleration& acceleration, const Seen& seen) {
  for (int i = 0; i < steps; ++i) {
    const double h = step;
    const Vector a1 = acceleration(q, v), a2 = acceleration(q + h / 2 * v, v + h / 2 * a1),
                 a3 = acceleration(q + h / 2 * v + h * h / 4 * a1, v + h / 2 * a2),
                 a4 = acceleration(q + h * v + h * h / 2 * a2, v + h * a3);
    q += h * v + h * h / 6 * (a1 + a2 + a3);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    seen(q, v);
  }
}

Eigen::Vector2d turned(double angle, double x, double y) {
  return {std::cos(angle) * x - std::sin(angle) * y, std::sin(angle) * x + std::cos(angle) * y};
}

// Coordinates β Θ γ δ Φ ε Ω. What the file cannot say: the motor, and the spring from a point of k3 to C.
struct Andrews {
  andrews::Workspace w;

  static Vector start() {
    Vector q(7);
    q << -0.0617138900142764496, 0, 0.455279819163070380, 0.487364979543842550, 0.222668390165885885, 1.23054744454982120,
        -0.222668390165885885;
    return q;
  }
  static Vector end() {  // at 0.03 s (IVP test set)
    Vector q(7);
    q << 15.81077119629904, -15.75637105984298, 0.04082224013073101, 0.5244099658805304, -0.5347301163226948, 1.048080741042263,
        0.5347301163226948;
    return q;
  }
  Vector acceleration(const Vector& q, const Vector& v) {
    Vector tau = Vector::Zero(7);
    tau[0] = 0.033;
    const Eigen::Vector2d arm = turned(q[2], 20e-3, -18e-3), point = arm + Eigen::Vector2d(-0.03635, 0.03273),
                          along = point - Eigen::Vector2d(0.014, 0.072), force = -4530 * (1 - 0.07785 / along.norm()) * along;
    tau[2] = arm[0] * force[1] - arm[1] * force[0];
    andrews::forward_dynamics(q.data(), v.data(), tau.data(), w);
    return andrews::constrained_forward_dynamics(w);
  }
  static double gap(const Vector& q) {
    const Eigen::Vector2d tip = turned(q[0], 7e-3, 0) + turned(q[0] + q[1], -28e-3, 0), a(-0.06934, -0.00227),
                          of_k3 = Eigen::Vector2d(-0.03635, 0.03273) + turned(q[2], 0, -35e-3),
                          of_k4 = a + turned(q[3], 4e-2, 0) + turned(q[3] + q[4], 0, -2e-2),
                          of_k6 = a + turned(q[5], 0, -4e-2) + turned(q[5] + q[6], 2e-2, 0);
    return std::max({(tip - of_k3).norm(), (tip - of_k4).norm(), (tip - of_k6).norm()});
  }
};

TEST(AndrewsSqueezer, BeginsAsPublished) {
  Andrews robot;
  const Vector q = Andrews::start(), a = robot.acceleration(q, Vector::Zero(7));
  EXPECT_NEAR(a[0], 14222.4439199541, 2e-6);
  EXPECT_NEAR(a[1], -10666.8329399656, 2e-6);
  // Forces of the first pin, on k3, which are along k2's axes.
  const Vector f = andrews::constraint_forces(robot.w);
  const Eigen::Vector2d first = turned(q[0] + q[1], f[0], f[1]);
  EXPECT_NEAR(first[0], 98.5668703962, 1e-8);
  EXPECT_NEAR(first[1], -6.1226883443, 1e-8);
  EXPECT_EQ(robot.w.forward_dynamics_constraint_status.rank, 6);
}

TEST(AndrewsSqueezer, EndsAsPublished) {
  Andrews robot;
  Vector q = Andrews::start(), v = Vector::Zero(7);
  integrate(
      q, v, 1e-5, 3000, [&](const Vector& at, const Vector& rate) { return robot.acceleration(at, rate); },
      [](const Vector&, const Vector&) {});
  EXPECT_LT(largest(q - Andrews::end()), 2e-8);
  EXPECT_LT(Andrews::gap(q), 1e-9);
}

// Five hinges in a chain and one that closes it: five rows of rank four, in every state.
TEST(Bricard, KeepsItsEnergyThoughARowIsRedundant) {
  bricard::Workspace w;
  Vector q = Vector::Zero(5), v = Vector::Zero(5);
  const Vector tau = Vector::Zero(5);
  const auto energy = [&](const Vector& at, const Vector& rate) {
    bricard::evaluate(at.data(), rate.data(), w);
    return w.kinetic_energy[0] + w.potential_energy[0];
  };
  const double before = energy(q, v);
  EXPECT_NEAR(before, -29.43, 1e-9);
  double worst = 0, residual = 0, gap = 0, moved = 0;
  integrate(
      q, v, 1e-3, 10000,
      [&](const Vector& at, const Vector& rate) {
        bricard::forward_dynamics(at.data(), rate.data(), tau.data(), w);
        EXPECT_EQ(w.forward_dynamics_constraint_status.rank, 4);
        residual = std::max(residual, w.forward_dynamics_constraint_status.residual);
        return Vector(bricard::constrained_forward_dynamics(w));
      },
      [&](const Vector& at, const Vector& rate) {
        worst = std::max(worst, std::abs(energy(at, rate) - before));
        // The end of the last rod against the base's hinge.
        const Eigen::Map<const Eigen::Matrix<double, 3, 4>> last(w.pose_rod_5);
        gap = std::max(gap, (last.leftCols(3) * Eigen::Vector3d(0, 1, 0) + last.col(3) - Eigen::Vector3d(0, 0, 1)).norm());
        moved = std::max(moved, std::abs(at[0]));
      });
  EXPECT_LT(worst, 1e-5);  // of 29.43 J; with steps of 4 ms 256 times as much, as the order of the steps has it
  EXPECT_LT(gap, 1e-6);
  EXPECT_LT(residual, 1e-4);
  EXPECT_GT(moved, 0.5);
}

// Two windows of three uprights: one motion, which passes through states where all links are in a line.
struct FourBars {
  four_bars::Workspace w;
  Vector q = Vector::Zero(5), v{5};
  double before = 0, worst = 0, gap = 0, least_pivot = 1;

  FourBars() {
    v << -1, 1, -1, 1, -1;
    before = energy(q, v);
  }
  double energy(const Vector& at, const Vector& rate) {
    four_bars::evaluate(at.data(), rate.data(), w);
    return w.kinetic_energy[0] + w.potential_energy[0];
  }
  static double open(const Vector& q) {
    double most = 0;
    for (int i = 0; i < 2; ++i) {
      const double foot = q[2 * i], across = foot + q[2 * i + 1], next = q[2 * i + 2];
      const Eigen::Vector2d end = Eigen::Vector2d(i, 0) + turned(foot, 0, 1) + turned(across, 1, 0),
                            top = Eigen::Vector2d(i + 1, 0) + turned(next, 0, 1);
      most = std::max(most, (end - top).norm());
    }
    return most;
  }
  void hold() {
    w.loop_first.kp = w.loop_second.kp = 400;
    w.loop_first.kd = w.loop_second.kd = 40;
  }
  void run(double seconds) {
    const Vector tau = Vector::Zero(5);
    integrate(
        q, v, 1e-3, static_cast<int>(seconds * 1000),
        [&](const Vector& at, const Vector& rate) {
          four_bars::forward_dynamics(at.data(), rate.data(), tau.data(), w);
          least_pivot = std::min(least_pivot, w.forward_dynamics_constraint_status.least_pivot);
          return Vector(four_bars::constrained_forward_dynamics(w));
        },
        [&](const Vector& at, const Vector& rate) {
          worst = std::max(worst, std::abs(energy(at, rate) - before));
          gap = std::max(gap, open(at));
        });
  }
};

TEST(FourBars, KeepTheirEnergyThroughFlatStates) {
  FourBars robot;
  robot.hold();
  robot.run(10);
  EXPECT_LT(robot.worst, 1e-6);
  EXPECT_LT(robot.gap, 1e-6);
  EXPECT_LT(robot.q[0], -25);          // some turns, each through two flat states
  EXPECT_LT(robot.least_pivot, 1e-5);  // which are singular
  // Without gains they keep it up to the first.
  FourBars loose;
  loose.run(2.6);
  EXPECT_LT(loose.worst, 1e-6);
  EXPECT_LT(loose.gap, 1e-6);
}

TEST(FourBars, AreHeldTogetherByTheirGains) {
  FourBars robot;
  robot.hold();
  robot.q[1] += 1e-3;  // open by a millimetre
  robot.run(1);
  EXPECT_LT(FourBars::open(robot.q), 1e-6);
  FourBars loose;
  loose.q[1] += 1e-3;
  loose.run(1);
  EXPECT_NEAR(FourBars::open(loose.q), 1e-3, 2e-4);  // no gain: it stays as it is
}

// Crank, rod and slider: only the crank has a motor.
struct SliderCrank {
  slider_crank_workspace w;
  Vector q{3}, v{3};

  explicit SliderCrank(double crank) {
    const double rod = -std::asin(0.2 / 0.5 * std::sin(crank)), slide = 0.2 * std::cos(crank) + 0.5 * std::cos(rod);
    q << crank, rod - crank, slide;
    const double rate = 1.7, rod_rate = -0.2 * std::cos(crank) / (0.5 * std::cos(rod)) * rate;
    v << rate, rod_rate - rate, -0.2 * std::sin(crank) * rate - 0.5 * std::sin(rod) * rod_rate;
  }
  Vector forward(const Vector& tau) {
    slider_crank::forward_dynamics(q.data(), v.data(), tau.data(), w);
    return slider_crank::constrained_forward_dynamics(w);
  }
};

TEST(SliderCrank, IsDrivenByItsOnlyMotor) {
  for (const double crank : {0.3, 1.2, 2.8, -1.9}) {
    SliderCrank robot(crank);
    slider_crank::evaluate(robot.q.data(), robot.v.data(), robot.w);
    const Matrix J = slider_crank::constraint_jacobian(robot.w), bias = slider_crank::constraint_bias(robot.w);
    EXPECT_LT(largest(J * robot.v), 1e-14);
    // An acceleration that the pin allows: 2 rad/s^2 of the crank and what follows.
    Vector wanted(3);
    wanted[0] = 2;
    wanted.tail(2) = J.rightCols(2).inverse() * (-bias - 2 * J.col(0));
    slider_crank::inverse_dynamics(robot.q.data(), robot.v.data(), wanted.data(), robot.w);
    const Vector tau = slider_crank::constrained_inverse_dynamics(robot.w),
                 f = slider_crank::inverse_constraint_forces(robot.w);
    EXPECT_LT(largest(tau.tail(2)), 1e-13);
    EXPECT_LT(robot.w.inverse_dynamics_support_status.residual, 1e-13);
    EXPECT_EQ(robot.w.inverse_dynamics_support_status.rank, 2);
    EXPECT_LT(largest(robot.forward(tau) - wanted), 1e-9 * largest(wanted));
    EXPECT_LT(largest(slider_crank::constraint_forces(robot.w) - f), 1e-9 * largest(f));
    // What the pin forbids is left to it: the motion is the nearest, in M's measure, to what was asked for.
    const Vector forbidden = wanted + Vector(Eigen::Vector3d(0.4, -3, 0.7));
    slider_crank::inverse_dynamics(robot.q.data(), robot.v.data(), forbidden.data(), robot.w);
    const Vector driven = slider_crank::constrained_inverse_dynamics(robot.w);
    EXPECT_LT(largest(driven.tail(2)), 1e-13);
    const Matrix M = slider_crank::mass_matrix(robot.w), inverse = M.inverse();
    const Vector nearest =
        forbidden + inverse * J.transpose() * (J * inverse * J.transpose()).inverse() * (-bias - J * forbidden);
    EXPECT_LT(largest(robot.forward(driven) - nearest), 1e-9 * largest(nearest));
  }
}

TEST(SliderCrank, StopsAsAWhole) {
  SliderCrank robot(0.9);
  robot.v << 1, 2, -0.5;  // against the pin
  slider_crank::evaluate(robot.q.data(), robot.v.data(), robot.w);
  const Matrix J = slider_crank::constraint_jacobian(robot.w), M = slider_crank::mass_matrix(robot.w);
  const Vector after = slider_crank::impact(robot.w), lost = robot.v - after;
  EXPECT_LT(largest(J * after), 1e-12);
  EXPECT_NEAR(robot.v.dot(M * robot.v) - after.dot(M * after), lost.dot(M * lost), 1e-12);
  robot.w.loop_pin.restitution = 1;
  slider_crank::evaluate(robot.q.data(), robot.v.data(), robot.w);
  const Vector thrown = slider_crank::impact(robot.w);
  EXPECT_LT(largest(J * (thrown + robot.v)), 1e-12);
  EXPECT_NEAR(thrown.dot(M * thrown), robot.v.dot(M * robot.v), 1e-12);  // all that came goes
}

TEST(SliderCrank, IsSetInCAndAllocatesNothing) {
  SliderCrank robot(0.9);
  const double regularization[2] = {3, 4}, weight[2] = {0.5, 2};
  const Vector tau = Vector(Eigen::Vector3d(1, 0, 0));
  const Vector held = robot.forward(tau);
  slider_crank_set_loop_pin(0, 100, 20, 0.5, regularization, &robot.w);
  slider_crank_weigh_loop_pin(weight, &robot.w);
  EXPECT_FALSE(robot.w.loop_pin.active);
  EXPECT_EQ(robot.w.loop_pin.kp, 100);
  EXPECT_EQ(robot.w.loop_pin.regularization[1], 4);
  EXPECT_EQ(robot.w.loop_pin.weight[1], 2);
  const Vector loose = robot.forward(tau);
  EXPECT_EQ(largest(slider_crank::constraint_forces(robot.w)), 0);
  EXPECT_GT(largest(held - loose), 0.1);
  const std::uint64_t allocations = dalembert::testing::heap_allocations();
  slider_crank_evaluate(robot.q.data(), robot.v.data(), &robot.w);
  slider_crank_forward_dynamics(robot.q.data(), robot.v.data(), tau.data(), &robot.w);
  slider_crank_inverse_dynamics(robot.q.data(), robot.v.data(), tau.data(), &robot.w);
  EXPECT_EQ(dalembert::testing::heap_allocations(), allocations);
}

// At its dead points the crank cannot be stopped by the slider, nor the rows of a weld be told apart: no number is lost.
TEST(SliderCrank, HasNumbersAtItsDeadPoints) {
  for (const double crank : {0.0, 3.141592653589793}) {
    SliderCrank robot(crank);
    const Vector a = robot.forward(Vector(Eigen::Vector3d(0.3, 0, 0)));
    EXPECT_TRUE(a.allFinite());
    EXPECT_TRUE(Vector(slider_crank::constraint_forces(robot.w)).allFinite());
    EXPECT_EQ(robot.w.forward_dynamics_constraint_status.rank, 2);
  }
}

// Its pin embedded: the crank alone is left.
TEST(SliderCrankEmbedded, MovesAsItsRowsDo) {
  namespace one = slider_crank_embedded;
  static_assert(one::nq == 3 && one::nv == 1 && one::joints == 1);
  slider_crank_embedded_workspace w;
  for (const double crank : {0.3, 1.2, 2.8, -1.9}) {
    SliderCrank rows(crank);
    one::VectorQ q = rows.q;
    q[1] += 0.05, q[2] -= 0.03;
    const auto status = one::close_loops(q);
    EXPECT_TRUE(status.ok());
    EXPECT_LT(status.error, 1e-15);
    EXPECT_GT(status.least_pivot, 0.1);
    EXPECT_LT(largest(q - rows.q), 1e-14);
    const one::VectorV v = one::VectorV::Constant(rows.v[0]), tau = one::VectorV::Constant(2.3);
    const std::uint64_t allocations = dalembert::testing::heap_allocations();
    slider_crank_embedded_forward_dynamics(q.data(), v.data(), tau.data(), &w);
    slider_crank_embedded_evaluate(q.data(), v.data(), &w);
    EXPECT_EQ(dalembert::testing::heap_allocations(), allocations);
    const double a = one::forward_dynamics(w)[0], expected = rows.forward(Vector(Eigen::Vector3d(2.3, 0, 0)))[0];
    EXPECT_NEAR(a, expected, 1e-10 * std::abs(expected));
    EXPECT_NEAR(one::mass_matrix(w)(0, 0) * a + one::bias(w)[0], 2.3, 1e-12);
    slider_crank::evaluate(rows.q.data(), rows.v.data(), rows.w);
    EXPECT_NEAR(one::kinetic_energy(w)(0, 0), slider_crank::kinetic_energy(rows.w)(0, 0), 1e-13);
  }
}

// Energy over ten seconds: the crank is integrated, the rest follows.
TEST(SliderCrankEmbedded, KeepsItsEnergy) {
  namespace one = slider_crank_embedded;
  one::Workspace w;
  one::VectorQ q = SliderCrank(0.4).q;
  double y = q[0], rate = 15;
  const auto acceleration = [&](double at, double speed) {
    q[0] = at;
    EXPECT_LT(one::close_loops(q.data()).error, 1e-13);
    const double tau = 0;
    one::forward_dynamics(q.data(), &speed, &tau, w);
    return w.forward_dynamics[0];
  };
  const auto energy = [&] {
    q[0] = y;
    one::close_loops(q);
    one::evaluate(q.data(), &rate, w);
    return w.kinetic_energy[0] + w.potential_energy[0];
  };
  const double before = energy(), h = 1e-3;
  for (int i = 0; i < 10000; ++i) {
    const double a1 = acceleration(y, rate), a2 = acceleration(y + h / 2 * rate, rate + h / 2 * a1),
                 a3 = acceleration(y + h / 2 * rate + h * h / 4 * a1, rate + h / 2 * a2),
                 a4 = acceleration(y + h * rate + h * h / 2 * a2, rate + h * a3);
    y += h * rate + h * h / 6 * (a1 + a2 + a3);
    rate += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  EXPECT_GT(y, 10);  // it went round
  EXPECT_NEAR(energy(), before, 1e-7 * before);
}

// A rod across the slider's way does not tell where it goes.
TEST(SliderCrankEmbedded, SaysWhereItCannotFollow) {
  namespace one = slider_crank_embedded;
  one::Workspace w;
  const one::VectorV v = one::VectorV::Constant(0.5), tau = one::VectorV::Constant(1);
  one::VectorQ q = SliderCrank(0.4).q;
  one::forward_dynamics(q, v, tau, w);
  EXPECT_TRUE(w.forward_dynamics_linkage_status.ok());
  EXPECT_NE(one::forward_dynamics(w)[0], 0);
  q << 0.3, 1.5707963267948966 - 0.3, 0.2;
  one::forward_dynamics(q, v, tau, w);
  EXPECT_EQ(w.forward_dynamics_linkage_status.linkage, 0);
  EXPECT_LT(w.forward_dynamics_linkage_status.least_pivot, 1e-8);
  EXPECT_EQ(one::forward_dynamics(w)[0], 0);
  one::evaluate(q, v, w);
  EXPECT_EQ(one::mass_matrix(w)(0, 0), 0);
  const one::VectorQ before = q;
  EXPECT_EQ(one::close_loops(q).linkage, 0);
  EXPECT_EQ(q, before);
  double error = 0, pivot = 1;
  EXPECT_EQ(slider_crank_embedded_close_loops(q.data(), &error, &pivot), 0);
  EXPECT_GT(error, 0.1);
}

TEST(AnkleEmbedded, FollowsItsCranks) {
  ankle::Workspace w;
  ankle::VectorQ q = ankle::VectorQ::Zero();
  EXPECT_LT(ankle::close_loops(q).error, 1e-15);
  const ankle::VectorV v = ankle::VectorV::Constant(0.5), tau = ankle::VectorV::Constant(1);
  ankle::forward_dynamics(q, v, tau, w);
  EXPECT_TRUE(w.forward_dynamics_linkage_status.ok());
  const Vector a = ankle::forward_dynamics(w);
  EXPECT_GT(largest(a), 0.1);
  ankle::inverse_dynamics(q, v, ankle::VectorV(a), w);
  EXPECT_LT(largest(Vector(ankle::inverse_dynamics(w)) - Vector(tau)), 1e-12);
}

}  // namespace
