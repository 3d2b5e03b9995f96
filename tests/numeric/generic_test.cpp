// The generic engine's interface: closed forms, effects of joints, driven joints, Jacobians of links, wrong arguments.
#include <gtest/gtest.h>

#include "load_robot.hpp"
#include "reference/generic_model.hpp"
#include "reference/instances.hpp"
#include "scale.hpp"
#include "states.hpp"

namespace dalembert::testing {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using generic::Model;

ir::KinematicTree tree_named(const std::string& name, bool floating) {
  for (const TestRobot& robot : test_robots)
    if (robot.name == name) return load_robot(robot, floating);
  throw std::invalid_argument("no test robot " + name);
}

// Two point masses m1, m2 on rods of length l1, l2, turning about y, hanging along −z: the textbook's double pendulum.
TEST(Generic, DoublePendulumMatchesItsClosedForm) {
  const double m1 = 2, m2 = 3, l1 = 0.5, l2 = 0.7, g = 9.81, a = 0.3, b = -1.1, da = 0.9, db = -2.3;
  Model<double> model;
  model.gravity = {0, 0, -g};
  model.bodies.resize(2);
  for (auto& body : model.bodies) body.axis = Eigen::Vector3d::UnitY();
  model.bodies[0].inertia = {m1, {0, 0, -l1}, Eigen::Matrix3d::Zero()};
  model.bodies[1].inertia = {m2, {0, 0, -l2}, Eigen::Matrix3d::Zero()};
  model.bodies[1].parent = 0;
  model.bodies[1].translation = {0, 0, -l1};
  const auto result = generic::evaluate<double>(model, Eigen::Vector2d(a, b), Eigen::Vector2d(da, db));

  const double c = m2 * l1 * l2 * std::cos(b), s = m2 * l1 * l2 * std::sin(b);
  Eigen::Matrix2d M, C;
  M << (m1 + m2) * l1 * l1 + m2 * l2 * l2 + 2 * c, m2 * l2 * l2 + c, m2 * l2 * l2 + c, m2 * l2 * l2;
  C << -s * db, -s * (da + db), s * da, 0;
  const Eigen::Vector2d weight((m1 + m2) * g * l1 * std::sin(a) + m2 * g * l2 * std::sin(a + b), m2 * g * l2 * std::sin(a + b));
  EXPECT_LE((result.mass_matrix - M).norm(), 1e-14);
  EXPECT_LE((result.coriolis_matrix - C).norm(), 1e-14);
  EXPECT_LE((result.gravity - weight).norm(), 1e-13);
  EXPECT_LE((result.bias - C * Eigen::Vector2d(da, db) - weight).norm(), 1e-13);
}

// A free body: momentum, centrifugal terms and weight of one rigid body in its own axes.
TEST(Generic, FreeBodyMatchesNewtonAndEuler) {
  Model<double> model;
  model.floating_base = true;
  model.gravity = {0, 0, -9.81};
  model.base = {2, {0, 0, 0}, Eigen::Vector3d(0.1, 0.2, 0.25).asDiagonal()};
  VectorXd q(7), v(6);
  q << 5, 6, 7, 0.5, 0.5, 0.5, 0.5;  // a third of a turn about (1, 1, 1): the body's y axis points up
  v << 1, 2, 3, 0.4, 0.5, 0.6;
  const auto result = generic::evaluate<double>(model, q, v);
  const Eigen::Vector3d u = v.head<3>(), w = v.tail<3>(), I(0.1, 0.2, 0.25);
  VectorXd expected(6);
  expected << 2 * w.cross(u), w.cross(I.asDiagonal() * w);
  expected[1] += 2 * 9.81;
  EXPECT_LE((result.bias - expected).norm(), 1e-14);
  EXPECT_LE((result.gravity - VectorXd::Unit(6, 1) * 2 * 9.81).norm(), 1e-14);
}

TEST(Generic, JointEffectsEnterWhereTheyBelong) {
  const ir::KinematicTree tree = tree_named("prismatic_mix", true);
  const State state = moderate_state(tree, 1);
  const Model<double> plain = to_generic<double>(tree, test_gravity);
  Model<double> model = plain;
  model.bodies[1].armature = 0.3;
  model.bodies[2].damping = 0.7;
  model.bodies[3].friction = 0.9;
  model.bodies[4].stiffness = 1.3;
  model.bodies[4].rest = 0.4;
  const auto before = generic::evaluate<double>(plain, state.q, state.v),
             after = generic::evaluate<double>(model, state.q, state.v);
  const double sign = state.v[6 + 3] > 0 ? 1 : -1;
  const VectorXd spring = VectorXd::Unit(11, 10) * 1.3 * (state.q[7 + 4] - 0.4);
  const VectorXd extra = VectorXd::Unit(11, 8) * 0.7 * state.v[8] + VectorXd::Unit(11, 9) * 0.9 * sign + spring;
  EXPECT_LE(
      (after.mass_matrix - before.mass_matrix - 0.3 * MatrixXd::Identity(11, 11).col(7) * VectorXd::Unit(11, 7).transpose())
          .norm(),
      1e-15);
  EXPECT_EQ(after.coriolis_matrix, before.coriolis_matrix);
  EXPECT_EQ(after.gravity, before.gravity);
  EXPECT_LE((after.bias - before.bias - extra).norm(), 1e-13);
  // Inverse dynamics counts all four.
  const VectorXd acceleration = VectorXd::LinSpaced(11, -1, 2);
  const VectorXd tau = generic::inverse_dynamics<double>(model, state.q, state.v, acceleration);
  EXPECT_LE((tau - after.mass_matrix * acceleration - after.bias).norm(), 1e-12 * tau.norm());
  // No friction at rest.
  EXPECT_EQ(generic::bias<double>(model, state.q, VectorXd::Zero(11)),
            generic::bias<double>(plain, state.q, VectorXd::Zero(11)) + spring);
}

// Driven joints: q3 = −0.5 q1 + 0.2. The reduced M and C obey Ṁ = C + Cᵀ and C v + g = Newton-Euler like any other.
TEST(Generic, DrivenJointsShareACoordinate) {
  for (const bool floating : {false, true}) {
    const ir::KinematicTree tree = tree_named("chain_7", floating);
    const State state = moderate_state(tree, 5);
    const Model<long double> full = to_generic<long double>(tree, test_gravity);
    Model<long double> model = full;
    for (int k = 0; k < 7; ++k) model.coordinates.push_back({k < 3 ? k : k - 1, 1, 0});
    model.coordinates[3] = {1, -0.5, 0.2};
    const int base_q = floating ? 7 : 0, base_v = floating ? 6 : 0;
    ASSERT_EQ(model.nv(), base_v + 6);

    VectorX<long double> q = state.q.head(model.nq()).cast<long double>(), v = state.v.head(model.nv()).cast<long double>();
    VectorX<long double> q_full(base_q + 7), v_full(base_v + 7);
    q_full << q.head(base_q + 3), -0.5L * q[base_q + 1] + 0.2, q.tail(3);
    v_full << v.head(base_v + 3), -0.5L * v[base_v + 1], v.tail(3);
    const auto reduced = generic::evaluate<long double>(model, q, v),
               whole = generic::evaluate<long double>(full, q_full, v_full);

    EXPECT_LE(std::abs(v.dot(reduced.mass_matrix * v) - v_full.dot(whole.mass_matrix * v_full)), 1e-15);
    EXPECT_LE(std::abs(v.dot(reduced.bias) - v_full.dot(whole.bias)), 1e-14);
    EXPECT_LE((reduced.coriolis_matrix * v + reduced.gravity - reduced.bias).norm(), 1e-15 * reduced.bias.norm());
    EXPECT_LE((reduced.wrench_influence.transpose() * v - whole.wrench_influence.transpose() * v_full).norm(), 1e-15);
    const long double h = 1e-5L;
    const auto M_at = [&](long double t) {
      VectorX<long double> moved = q;
      moved.tail(6) += t * v.tail(6);
      return generic::mass_matrix<long double>(model, moved);
    };
    const MatrixX<long double> rate = (M_at(h) - M_at(-h)) / (2 * h);
    EXPECT_LE((rate - reduced.coriolis_matrix - reduced.coriolis_matrix.transpose()).norm(),
              1e-8L * reduced.coriolis_matrix.norm());
  }
}

TEST(Generic, LinkJacobianIsTheBodysRowsOfWMovedToTheLink) {
  const ir::KinematicTree tree = tree_named("branch_below_base", true);
  const State state = moderate_state(tree, 1);
  const Model<double> model = to_generic<double>(tree, test_gravity);
  const MatrixXd W = generic::wrench_influence<double>(model, state.q);
  for (int body = -1; body < tree.joints(); ++body) {
    EXPECT_LE((generic::link_jacobian<double>(model, state.q, body, Transform<double>()) -
               W.middleCols<6>(6 * (body + 1)).transpose())
                  .norm(),
              1e-15);
    const Transform<double> link{rotation_about<double>({0, 0.6, 0.8}, 0.4), {0.1, -0.2, 0.3}};
    const MatrixXd moved = generic::link_jacobian<double>(model, state.q, body, link);
    EXPECT_LE((adjoint(link) * moved - W.middleCols<6>(6 * (body + 1)).transpose()).norm(), 1e-14);
  }
}

TEST(Generic, DependsNotOnTheBasesPose) {
  const ir::KinematicTree tree = tree_named("quadruped", true);
  const Model<double> model = to_generic<double>(tree, test_gravity);
  State state = moderate_state(tree, 1);
  const auto here = generic::evaluate<double>(model, state.q, state.v);
  state.q.head<3>() *= 1e9;
  const auto far = generic::evaluate<double>(model, state.q, state.v);
  EXPECT_EQ(here.mass_matrix, far.mass_matrix);
  EXPECT_EQ(here.coriolis_matrix, far.coriolis_matrix);
  EXPECT_EQ(here.gravity, far.gravity);
  EXPECT_EQ(here.bias, far.bias);
  state.q.segment<4>(3) << 1, 0, 0, 0;
  const auto turned = generic::evaluate<double>(model, state.q, state.v);
  EXPECT_EQ(here.mass_matrix, turned.mass_matrix);
  EXPECT_EQ(here.coriolis_matrix, turned.coriolis_matrix);
}

TEST(Generic, RefusesArgumentsOfWrongSize) {
  Model<double> model = to_generic<double>(tree_named("chain_7", true), test_gravity);
  const VectorXd q = VectorXd::Zero(14), v = VectorXd::Zero(13);
  EXPECT_NO_THROW(generic::evaluate<double>(model, q, v));
  EXPECT_THROW(generic::evaluate<double>(model, v, v), std::invalid_argument);
  EXPECT_THROW(generic::evaluate<double>(model, q, q), std::invalid_argument);
  EXPECT_THROW(generic::mass_matrix<double>(model, v), std::invalid_argument);
  EXPECT_THROW(generic::inverse_dynamics<double>(model, q, v, q), std::invalid_argument);
  EXPECT_THROW(generic::link_jacobian<double>(model, q, 7, Transform<double>()), std::invalid_argument);
  model.bodies[3].parent = 3;
  EXPECT_THROW(generic::evaluate<double>(model, q, v), std::invalid_argument);
  model.bodies[3].parent = 2;
  model.coordinates.resize(6);
  EXPECT_THROW(generic::evaluate<double>(model, q, v), std::invalid_argument);
}

}  // namespace
}  // namespace dalembert::testing
