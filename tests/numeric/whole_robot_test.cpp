// Energy, centre of mass and momentum of the generic engine in a hundred digits, against bodies placed and moved one by one,
// and against M and g. Derivatives are central differences, as in identities.hpp.
#include <gtest/gtest.h>

#include <dalembert/generic/whole_robot.hpp>

#include "identities.hpp"
#include "load_robot.hpp"
#include "scale.hpp"
#include "states.hpp"

namespace dalembert::testing {
namespace {

constexpr double tolerance = 1e-25;
const Multi step("1e-30");

double relative(const Matrix& a, const Matrix& b) { return relative_error(a, b, std::max<Multi>(largest(a), largest(b))); }
double relative(const Multi& a, const Multi& b) { return relative(Matrix::Constant(1, 1, a), Matrix::Constant(1, 1, b)); }

// f after minus f before moving along v, over twice the step.
template <class Of>
auto rate(const Case& c, const Vector& v, const Of& of) {
  return ((of(integrate(c.model, c.q, v, step)) - of(integrate(c.model, c.q, v, -step))) / (2 * step)).eval();
}

using RobotAndBase = std::tuple<TestRobot, bool>;

class WholeRobot : public ::testing::TestWithParam<RobotAndBase> {
 protected:
  WholeRobot() {
    const auto [robot, floating] = GetParam();
    const ir::KinematicTree tree = load_robot(robot, floating);
    const State state = moderate_state(tree, 1);
    c = {exact_model(tree, test_gravity), exact_position(tree, state.q), state.v.cast<Multi>()};
    other = moderate_state(tree, 2).v.cast<Multi>();
    for (int k = 0; k < c.model.joints(); k += 2) c.model.bodies[static_cast<size_t>(k)].armature = Multi(k + 1) / 10;
  }

  generic::WholeRobot<Multi> at(const Vector& q, const Vector& v) const { return generic::whole_robot<Multi>(c.model, q, v); }

  // Bodies that move, with their world poses.
  template <class Action>
  void each_body(const Vector& q, const Action& action) const {
    const auto poses = world_poses(c.model, q);
    if (c.model.floating_base) action(c.model.base, poses[0]);
    for (size_t k = 0; k < c.model.bodies.size(); ++k) action(c.model.bodies[k].inertia, poses[k + 1]);
  }
  Vector3<Multi> center(const Vector& q) const {
    Multi mass = 0;
    Vector3<Multi> moment = Vector3<Multi>::Zero();
    each_body(q, [&](const Inertia<Multi>& body, const Transform<Multi>& pose) {
      mass += body.mass;
      moment += body.mass * (pose.rotation * body.com + pose.translation);
    });
    return moment / mass;
  }
  // Of all bodies at q, moving with v: about a point of the world.
  Vector momentum(const Vector& q, const Vector& v, const Vector3<Multi>& about) const {
    std::vector<Transform<Multi>> before, after;
    each_body(integrate(c.model, q, v, -step), [&](const auto&, const auto& pose) { before.push_back(pose); });
    each_body(integrate(c.model, q, v, step), [&](const auto&, const auto& pose) { after.push_back(pose); });
    Vector sum = Vector::Zero(6);
    size_t b = 0;
    each_body(q, [&](const Inertia<Multi>& body, const Transform<Multi>& pose) {
      const auto place = [&](const Transform<Multi>& p) { return Vector3<Multi>(p.rotation * body.com + p.translation); };
      const Vector3<Multi> p = body.mass * (place(after[b]) - place(before[b])) / (2 * step);
      const Matrix3<Multi> spin = (after[b].rotation - before[b].rotation) / (2 * step) * pose.rotation.transpose();
      const Vector3<Multi> w(spin(2, 1), spin(0, 2), spin(1, 0));
      sum.head<3>() += p;
      sum.tail<3>() += (place(pose) - about).cross(p) + pose.rotation * (body.inertia * (pose.rotation.transpose() * w));
      ++b;
    });
    return sum;
  }

  Case c;
  Vector other;  // another velocity
};

TEST_P(WholeRobot, KineticEnergyIsHalfOfVMV) {
  for (const Vector& v : {c.v, other})
    EXPECT_LE(relative(at(c.q, v).kinetic_energy, v.dot(generic::mass_matrix<Multi>(c.model, c.q) * v) / 2), tolerance);
}

TEST_P(WholeRobot, PotentialEnergyIsThatOfTheCentreAndItsGradientGravity) {
  const Vector gravity = generic::gravity<Multi>(c.model, c.q);
  Multi mass = 0;
  each_body(c.q, [&](const auto& body, const auto&) { mass += body.mass; });
  EXPECT_LE(relative(at(c.q, c.v).potential_energy, -mass * c.model.gravity.dot(center(c.q))), tolerance);
  const auto energy = [&](const Vector& q) { return Vector::Constant(1, at(q, c.v).potential_energy); };
  for (const Vector& v : {c.v, other}) EXPECT_LE(relative(rate(c, v, energy)[0], gravity.dot(v)), tolerance);
}

// What a robot at rest takes to be held is the gradient of the potential energy, springs included.
TEST_P(WholeRobot, SpringsStorePotentialEnergy) {
  for (int k = 0; k < c.model.joints(); k += 2) {
    if (c.model.bodies[static_cast<size_t>(k)].parts > 1) continue;  // no angle to store it by
    c.model.bodies[static_cast<size_t>(k)].stiffness = Multi(k + 1) * 3;
    c.model.bodies[static_cast<size_t>(k)].rest = Multi(k - 2) / 7;
  }
  const Vector held = generic::bias<Multi>(c.model, c.q, Vector::Zero(c.v.size()));
  const auto energy = [&](const Vector& q) { return Vector::Constant(1, at(q, c.v).potential_energy); };
  for (const Vector& v : {c.v, other}) EXPECT_LE(relative(rate(c, v, energy)[0], held.dot(v)), tolerance);
}

TEST_P(WholeRobot, CentreOfMassMovesAsItsJacobianSays) {
  EXPECT_LE(relative(at(c.q, c.v).center_of_mass, center(c.q)), tolerance);
  const auto of = [&](const Vector& q) { return center(q); };
  for (const Vector& v : {c.v, other}) EXPECT_LE(relative(rate(c, v, of), at(c.q, c.v).center_of_mass_jacobian * v), tolerance);
}

TEST_P(WholeRobot, CentreOfMassAcceleratesAsItsBiasSays) {
  for (const Vector& v : {c.v, other}) {
    const auto of = [&](const Vector& q) { return Matrix(at(q, v).center_of_mass_jacobian * v); };
    const Multi size = largest(at(c.q, v).center_of_mass_jacobian) * largest(v) * largest(v) / 1000;
    const Vector expected = rate(c, v, of);
    EXPECT_LE(relative_error(expected, Vector(at(c.q, v).center_of_mass_bias), std::max<Multi>(size, largest(expected))),
              tolerance);
  }
}

TEST_P(WholeRobot, MomentumMatrixGivesTheMomentumOfTheBodies) {
  const Matrix A = at(c.q, c.v).momentum_matrix;
  for (const Vector& v : {c.v, other}) EXPECT_LE(relative(A * v, momentum(c.q, v, center(c.q))), tolerance);
  Multi mass = 0;
  each_body(c.q, [&](const auto& body, const auto&) { mass += body.mass; });
  EXPECT_LE(relative(A.topRows<3>(), mass * at(c.q, c.v).center_of_mass_jacobian), tolerance);
}

TEST_P(WholeRobot, MomentumBiasIsTheRateOfTheMomentumMatrixTimesV) {
  for (const Vector& v : {c.v, other}) {
    const auto of = [&](const Vector& q) { return Matrix(at(q, v).momentum_matrix * v); };
    const Multi size = largest(at(c.q, v).momentum_matrix) * largest(v) * largest(v) / 1000;
    const Vector expected = rate(c, v, of);
    EXPECT_LE(relative_error(expected, Vector(at(c.q, v).momentum_bias), std::max<Multi>(size, largest(expected))), tolerance);
  }
}

// C_ij = ½ Σ_k (∂M_ij/∂q_k + ∂M_ik/∂q_j − ∂M_jk/∂q_i) v_k for the joints' rows and columns; and what every C must satisfy.
TEST_P(WholeRobot, ChristoffelsCIsMadeOfDerivativesOfM) {
  if (c.v.size() > 40) return;  // a derivative of M per coordinate
  const Vector C_v = generic::coriolis_matrix<Multi>(c.model, c.q, c.v) * c.v;
  c.model.coriolis = generic::Coriolis::christoffel;
  const Matrix C = generic::coriolis_matrix<Multi>(c.model, c.q, c.v);
  const auto M = [&](const Vector& q) { return generic::mass_matrix<Multi>(c.model, q); };
  const Eigen::Index nv = c.v.size(), base = c.model.base_rows();
  const Multi size = std::max<Multi>(largest(C), largest(M(c.q)) * largest(c.v) / 1000);
  EXPECT_LE(relative_error(Matrix(C * c.v), Matrix(C_v), Multi(size * largest(c.v))), tolerance);
  EXPECT_LE(relative_error(Matrix(rate(c, c.v, M)), Matrix(C + C.transpose()), size), tolerance);

  // Where a joint has a quaternion, v is not the rate of coordinates, and the formula has more terms.
  if (c.q.size() - c.v.size() != (base > 0 ? 1 : 0)) return;
  Matrix expected = rate(c, c.v, M);  // Σ_k ∂M_ij/∂q_k v_k
  for (Eigen::Index j = 0; j < nv; ++j) {
    const Vector column = rate(c, Vector::Unit(nv, j), M) * c.v;  // Σ_k ∂M_ik/∂q_j v_k
    expected.col(j) += column;
    expected.row(j) -= column.transpose();
  }
  expected /= 2;
  const Eigen::Index joints = nv - base;
  EXPECT_LE(
      relative_error(Matrix(C.bottomRightCorner(joints, joints)), Matrix(expected.bottomRightCorner(joints, joints)), size),
      tolerance);
}

INSTANTIATE_TEST_SUITE_P(Robots, WholeRobot,
                         ::testing::Combine(::testing::ValuesIn(test_robots_and_kinds()), ::testing::Bool()),
                         [](const auto& info) {
                           return std::string(std::get<0>(info.param).name) +
                                  (std::get<1>(info.param) ? "_floating" : "_fixed");
                         });

}  // namespace
}  // namespace dalembert::testing
