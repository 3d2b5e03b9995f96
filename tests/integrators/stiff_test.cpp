// Joints far stiffer than the step: what stays bounded, and what does not.
#include <gtest/gtest.h>

#include <cmath>

#include "systems.hpp"

namespace dalembert::testing {
namespace {

using S = System<FreeMahru>;

// MAHRU with springs and a little motion in every joint.
struct Case {
  S system;
  S::VectorQ q;
  S::VectorV v;

  explicit Case(double stiffness, double damping = 0) {
    system.stiffness.tail<25>().setConstant(stiffness);
    system.damping.tail<25>().setConstant(damping);
    q.setZero();
    q[6] = 1;
    for (int i = 0; i < 25; ++i) q[7 + i] = 1e-4 * std::sin(1 + i);
    v.setConstant(0.1);
  }
};

TEST(StiffJoints, LinearlyImplicitStaysBoundedWhereRk4Diverges) {
  Case implicit(1e9);
  const double before = implicit.system.energy(implicit.q, implicit.v);
  for (int i = 0; i < 10000; ++i) {
    integrators::linearly_implicit(implicit.system, 1e-3, implicit.q, implicit.v);
    ASSERT_LE(implicit.system.energy(implicit.q, implicit.v), 1.01 * before) << "step " << i;
  }
  EXPECT_LT(implicit.q.tail<25>().cwiseAbs().maxCoeff(), 1e-6) << "the springs hold the joints";

  Case direct(1e9);
  int steps = 0;
  while (steps < 100 && direct.v.allFinite() && direct.v.cwiseAbs().maxCoeff() < 1e6)
    integrators::rk4(direct.system, 1e-3, direct.q, direct.v), ++steps;
  EXPECT_LT(steps, 100) << "RK4 should not bear this";
}

TEST(StiffJoints, RangeOfSpringsDampersAndSteps) {
  for (double stiffness : {1.0, 1e3, 1e6, 1e9})
    for (double damping : {0.0, 1.0, 1e6, 1e9})
      for (double h : {1e-4, 1e-3, 1e-2}) {
        Case stiff(stiffness, damping);
        const double before = stiff.system.energy(stiff.q, stiff.v);
        for (int i = 0; i < 300; ++i) integrators::linearly_implicit(stiff.system, h, stiff.q, stiff.v);
        EXPECT_LE(stiff.system.energy(stiff.q, stiff.v), 1.01 * before)
            << stiffness << " N m/rad, " << damping << " N m s/rad, " << h << " s";
      }
}

// One joint 1e9 times stiffer than the others.
TEST(StiffJoints, RatioOfABillionWithinOneRobot) {
  Case stiff(1);
  stiff.system.stiffness[6] = 1e9;
  const double before = stiff.system.energy(stiff.q, stiff.v);
  for (int i = 0; i < 3000; ++i) integrators::linearly_implicit(stiff.system, 1e-3, stiff.q, stiff.v);
  EXPECT_LE(stiff.system.energy(stiff.q, stiff.v), 1.01 * before);
  EXPECT_LT(std::abs(stiff.q[7]), 1e-6);
  EXPECT_GT(stiff.q.tail<24>().cwiseAbs().maxCoeff(), 1e-3) << "the soft joints swing";
}

TEST(StiffJoints, MidpointKeepsTheEnergyOfStiffSprings) {
  Case stiff(1e5);
  const double before = stiff.system.energy(stiff.q, stiff.v);
  for (int i = 0; i < 3000; ++i)
    ASSERT_TRUE(integrators::implicit_midpoint(stiff.system, 1e-3, stiff.q, stiff.v)) << "step " << i;
  EXPECT_NEAR(stiff.system.energy(stiff.q, stiff.v), before, 0.02 * before);
}

// So stiff that a step's mean speed all but vanishes beside the speeds at its ends: what is left of it is rounding.
TEST(StiffJoints, MidpointConvergesWhereJointsSwingToAndFro) {
  System<PendulumChain> chain;
  chain.stiffness.setConstant(1e9);
  System<PendulumChain>::VectorQ q = System<PendulumChain>::VectorQ::Zero();
  System<PendulumChain>::VectorV v = System<PendulumChain>::VectorV::Constant(0.1);
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(integrators::implicit_midpoint(chain, 1e-3, q, v)) << "step " << i;
  EXPECT_LT(v.cwiseAbs().maxCoeff(), 10);
}

}  // namespace
}  // namespace dalembert::testing
