// The generic engine's inverse and forward dynamics, derivatives and regressor: identities in double on every test robot, and
// to 100 digits on a few, with and without driven joints, armature, damping, friction and external wrenches.
#include <gtest/gtest.h>

#include <dalembert/generic/constraints.hpp>

#include "identities.hpp"
#include "load_robot.hpp"
#include "reference/generic_model.hpp"
#include "reference/instances.hpp"
#include "scale.hpp"
#include "states.hpp"

namespace dalembert::testing {
namespace {

const Multi step("1e-30");
constexpr double to_100_digits = 1e-90, to_differences = 1e-50;

// A robot in a state, and every other argument that a function may take.
template <class S>
struct Setting {
  generic::Model<S> model;
  VectorX<S> q, v, v_dot, tau, wrenches;
};

template <class S>
VectorX<S> random_vector(Random& random, Eigen::Index size) {
  VectorX<S> result(size);
  for (S& x : result) x = S(random.uniform(-2, 2));
  return result;
}

// Effects of joints, and, where there are joints enough, two of them that others drive.
template <class S>
void complicate(generic::Model<S>& model) {
  const int n = model.joints();
  for (int k = 0; k < n; ++k) {
    generic::Body<S>& body = model.bodies[static_cast<size_t>(k)];
    body.armature = S(1 + k) / 16;
    body.damping = S(3 + k) / 8;
    body.friction = S(2 + k) / 4;
    body.stiffness = body.part < 0 ? S(4 + k) / 2 : S(0);
    body.rest = S(1 + k) / 8;
  }
  if (n < 4 || model.quaternions() > 0) return;
  for (int k = 0; k < n; ++k) model.coordinates.push_back({k < 2 ? k : k < n - 1 ? k - 1 : 0, S(1), S(0)});
  model.coordinates[2] = {1, S(-0.5), S(0.25)};
  model.coordinates[static_cast<size_t>(n - 1)] = {0, S(1.5), S(-0.125)};
}

template <class S>
Setting<S> setting(generic::Model<S> model, bool complicated, std::uint64_t seed) {
  if (complicated) complicate(model);
  Random random(seed);
  Setting<S> result{model, random_vector<S>(random, model.nq()), {}, {}, {}, {}};
  if (model.floating_base) result.q.template segment<4>(3).normalize();
  Eigen::Index at = model.floating_base ? 7 : 0;
  for (const generic::Body<S>& body : model.bodies) {
    if (body.part == 0) {
      result.q.template segment<4>(at + body.parts - 3).normalize();
      at += body.parts + 1;
    } else if (body.part < 0) {
      ++at;
    }
  }
  for (VectorX<S>* vector : {&result.v, &result.v_dot, &result.tau}) *vector = random_vector<S>(random, model.nv());
  result.wrenches = random_vector<S>(random, 6 * model.moving_bodies());
  return result;
}

ir::KinematicTree tree_named(const std::string& name, bool floating) {
  if (name == kinds_robot.name) return load_robot(kinds_robot, floating);
  for (const TestRobot& robot : test_robots)
    if (robot.name == name) return load_robot(robot, floating);
  throw std::invalid_argument("no test robot " + name);
}

template <class S>
double relative(const MatrixX<S>& a, const MatrixX<S>& b) {
  return relative_error(a, b, std::max<S>(largest(a), largest(b)));
}

// Column i: how `function`, of a configuration, changes along v's coordinate i.
template <class Function>
Matrix difference_along_q(const Setting<Multi>& s, const Function& function) {
  Matrix result(s.model.nv(), s.model.nv());
  for (Eigen::Index i = 0; i < result.cols(); ++i) {
    const Vector direction = Vector::Unit(result.cols(), i);
    result.col(i) =
        (function(integrate(s.model, s.q, direction, step)) - function(integrate(s.model, s.q, direction, -step))) / (2 * step);
  }
  return result;
}
template <class Function>
Matrix difference_along_v(const Setting<Multi>& s, const Function& function) {
  Matrix result(s.model.nv(), s.model.nv());
  for (Eigen::Index i = 0; i < result.cols(); ++i) {
    const Vector change = step * Vector::Unit(result.cols(), i);
    result.col(i) = (function(s.v + change) - function(s.v - change)) / (2 * step);
  }
  return result;
}

using RobotBaseAndEffects = std::tuple<std::string, bool, bool>;
std::string robot_base_and_effects(const ::testing::TestParamInfo<RobotBaseAndEffects>& info) {
  const auto [robot, floating, complicated] = info.param;
  return robot + (floating ? "_floating" : "_fixed") + (complicated ? "_with_effects" : "");
}

class In100Digits : public ::testing::TestWithParam<RobotBaseAndEffects> {
 protected:
  static Setting<Multi> make() {
    const auto [robot, floating, complicated] = GetParam();
    return setting(exact_model(tree_named(robot, floating), test_gravity), complicated, 7);
  }
  const Setting<Multi> s = make();
};

TEST_P(In100Digits, InverseDynamicsIsTheEquationOfMotion) {
  const auto terms = generic::evaluate<Multi>(s.model, s.q, s.v);
  const Vector expected = terms.mass_matrix * s.v_dot + terms.bias - terms.wrench_influence * s.wrenches;
  EXPECT_LE(relative<Multi>(expected, generic::inverse_dynamics<Multi>(s.model, s.q, s.v, s.v_dot, s.wrenches)), to_100_digits);
}

TEST_P(In100Digits, DerivativesOfInverseDynamicsAreItsDifferences) {
  const auto exact = generic::inverse_dynamics_derivatives<Multi>(s.model, s.q, s.v, s.v_dot, s.wrenches);
  const auto of_q = [&](const Vector& q) { return generic::inverse_dynamics<Multi>(s.model, q, s.v, s.v_dot, s.wrenches); };
  const auto of_v = [&](const Vector& v) { return generic::inverse_dynamics<Multi>(s.model, s.q, v, s.v_dot, s.wrenches); };
  EXPECT_LE(relative<Multi>(exact.dq, difference_along_q(s, of_q)), to_differences);
  EXPECT_LE(relative<Multi>(exact.dv, difference_along_v(s, of_v)), to_differences);
}

TEST_P(In100Digits, DerivativesOfForwardDynamicsAreItsDifferences) {
  const auto exact = generic::forward_dynamics_derivatives<Multi>(s.model, s.q, s.v, s.tau, s.wrenches);
  ASSERT_TRUE(exact.status.ok());
  const auto of_q = [&](const Vector& q) { return generic::forward_dynamics<Multi>(s.model, q, s.v, s.tau, s.wrenches).value; };
  const auto of_v = [&](const Vector& v) { return generic::forward_dynamics<Multi>(s.model, s.q, v, s.tau, s.wrenches).value; };
  EXPECT_LE(relative<Multi>(exact.dq, difference_along_q(s, of_q)), to_differences);
  EXPECT_LE(relative<Multi>(exact.dv, difference_along_v(s, of_v)), to_differences);
}

TEST_P(In100Digits, InverseDynamicsUndoesForwardDynamics) {
  const auto v_dot = generic::forward_dynamics<Multi>(s.model, s.q, s.v, s.tau, s.wrenches);
  ASSERT_TRUE(v_dot.status.ok());
  const Vector tau = generic::inverse_dynamics<Multi>(s.model, s.q, s.v, v_dot.value, s.wrenches);
  EXPECT_LE(relative<Multi>(tau, s.tau), to_100_digits);
}

TEST_P(In100Digits, InverseTimesMassMatrixIsOne) {
  const auto inverse = generic::inverse_mass_matrix<Multi>(s.model, s.q);
  ASSERT_TRUE(inverse.status.ok());
  const Matrix M = generic::mass_matrix<Multi>(s.model, s.q), one = Matrix::Identity(M.rows(), M.rows());
  EXPECT_LE(largest(Matrix(M * inverse.value - one)), to_100_digits);
}

TEST_P(In100Digits, FactorsMakeMassMatrix) {
  const auto factor = generic::mass_matrix_factor<Multi>(s.model, s.q);
  ASSERT_TRUE(factor.status.ok());
  Matrix upper = factor.value;
  const Vector pivots = upper.diagonal();
  upper.diagonal().setOnes();
  EXPECT_LE(relative<Multi>(Matrix(upper * pivots.asDiagonal() * upper.transpose()), generic::mass_matrix<Multi>(s.model, s.q)),
            to_100_digits);
}

TEST_P(In100Digits, RegressorTimesParametersIsInverseDynamics) {
  generic::Model<Multi> plain = s.model;
  for (generic::Body<Multi>& body : plain.bodies) body.armature = body.damping = body.friction = body.stiffness = 0;
  const Vector expected = generic::inverse_dynamics<Multi>(plain, s.q, s.v, s.v_dot, Vector());
  const Matrix Y = generic::regressor<Multi>(s.model, s.q, s.v, s.v_dot);
  EXPECT_LE(relative<Multi>(Y * generic::inertial_parameters(s.model), expected), to_100_digits);
  // Of its parameters a body's own column each: another body's mass is another column.
  plain.bodies.back().inertia.mass += 1;
  plain.bodies.back().inertia.com.setZero();
  plain.bodies.back().inertia.inertia << 3, 1, 2, 1, 4, -1, 2, -1, 5;
  EXPECT_LE(relative<Multi>(Y * generic::inertial_parameters(plain),
                            generic::inverse_dynamics<Multi>(plain, s.q, s.v, s.v_dot, Vector())),
            to_100_digits);
}

INSTANTIATE_TEST_SUITE_P(Robots, In100Digits,
                         ::testing::Combine(::testing::Values("branch_below_base", "prismatic_mix", "skew_axes", "kinds_mixed"),
                                            ::testing::Bool(), ::testing::Bool()),
                         robot_base_and_effects);

class InDouble : public ::testing::TestWithParam<std::tuple<TestRobot, bool>> {};

// What holds to rounding, and to rounding times the condition of M where M is inverted.
TEST_P(InDouble, IdentitiesHold) {
  const auto [robot, floating] = GetParam();
  const ir::KinematicTree tree = load_robot(robot, floating);
  for (const bool complicated : {false, true}) {
    const Setting<double> s = setting(to_generic<double>(tree, test_gravity), complicated, 3);
    const auto terms = generic::evaluate<double>(s.model, s.q, s.v);
    const Eigen::MatrixXd& M = terms.mass_matrix;
    const auto inverse = generic::inverse_mass_matrix<double>(s.model, s.q);
    ASSERT_TRUE(inverse.status.ok()) << inverse.status.coordinate;
    const double condition = M.norm() * inverse.value.norm();
    EXPECT_LE((M * inverse.value - Eigen::MatrixXd::Identity(M.rows(), M.rows())).norm(), 1e-15 * condition);

    const auto v_dot = generic::forward_dynamics<double>(s.model, s.q, s.v, s.tau, s.wrenches);
    const Eigen::VectorXd tau = generic::inverse_dynamics<double>(s.model, s.q, s.v, v_dot.value, s.wrenches);
    const Eigen::VectorXd moved = s.tau - terms.bias + terms.wrench_influence * s.wrenches;
    EXPECT_LE((tau - s.tau).norm(), 1e-14 * condition * moved.norm());

    // ∂τ/∂v depends on no acceleration.
    const auto here = generic::inverse_dynamics_derivatives<double>(s.model, s.q, s.v, s.v_dot, s.wrenches),
               there = generic::inverse_dynamics_derivatives<double>(s.model, s.q, s.v, 2 * s.v_dot, s.wrenches);
    EXPECT_LE((here.dv - there.dv).norm(), 1e-13 * here.dv.norm());
    const Eigen::VectorXd needed = generic::inverse_dynamics<double>(s.model, s.q, s.v, s.v_dot);
    const Eigen::VectorXd by_parameters =
        generic::regressor<double>(s.model, s.q, s.v, s.v_dot) * generic::inertial_parameters(s.model);
    if (!complicated) {
      EXPECT_LE((needed - by_parameters).norm(), 1e-13 * std::max(needed.norm(), M.norm() * s.v.squaredNorm()));
    }
    // τ does not depend on where the base is.
    if (floating) {
      EXPECT_LE(here.dq.leftCols<3>().norm(), 1e-13 * here.dq.norm());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, InDouble, ::testing::Combine(::testing::ValuesIn(test_robots), ::testing::Bool()),
                         [](const auto& info) {
                           return std::string(std::get<0>(info.param).name) +
                                  (std::get<1>(info.param) ? "_floating" : "_fixed");
                         });

// Rounding alone separates double from 100 digits.
TEST(GenericDynamics, DoubleIsTheExactRounded) {
  for (const char* robot : {"mahru", "quadruped", "gantry_arms", "skew_axes"}) {
    for (const bool floating : {false, true}) {
      const ir::KinematicTree tree = tree_named(robot, floating);
      const Setting<double> s = setting(to_generic<double>(tree, test_gravity), true, 11);
      generic::Model<Multi> model = to_generic<Multi>(tree, test_gravity);
      complicate(model);
      const auto exactly = [](const Eigen::VectorXd& x) { return Vector(x.cast<Multi>()); };
      const Vector q = exactly(s.q), v = exactly(s.v), v_dot = exactly(s.v_dot), tau = exactly(s.tau), F = exactly(s.wrenches);
      const auto error = [](const auto& rounded, const Matrix& exact) {
        return relative<Multi>(rounded.template cast<Multi>(), exact);
      };
      const auto did = generic::inverse_dynamics_derivatives<double>(s.model, s.q, s.v, s.v_dot, s.wrenches);
      const auto exact_did = generic::inverse_dynamics_derivatives<Multi>(model, q, v, v_dot, F);
      EXPECT_LE(error(did.dq, exact_did.dq), 1e-14) << robot;
      EXPECT_LE(error(did.dv, exact_did.dv), 1e-14) << robot;
      EXPECT_LE(error(generic::inverse_dynamics<double>(s.model, s.q, s.v, s.v_dot, s.wrenches),
                      generic::inverse_dynamics<Multi>(model, q, v, v_dot, F)),
                1e-14)
          << robot;
      EXPECT_LE(error(generic::regressor<double>(s.model, s.q, s.v, s.v_dot), generic::regressor<Multi>(model, q, v, v_dot)),
                1e-14)
          << robot;

      const auto inverse = generic::inverse_mass_matrix<Multi>(model, q);
      const double condition = static_cast<double>(largest(generic::mass_matrix<Multi>(model, q)) * largest(inverse.value)),
                   limit = 1e-15 * condition;
      EXPECT_LE(error(generic::inverse_mass_matrix<double>(s.model, s.q).value, inverse.value), limit) << robot;
      EXPECT_LE(error(generic::forward_dynamics<double>(s.model, s.q, s.v, s.tau, s.wrenches).value,
                      generic::forward_dynamics<Multi>(model, q, v, tau, F).value),
                limit)
          << robot;
      const auto dfd = generic::forward_dynamics_derivatives<double>(s.model, s.q, s.v, s.tau, s.wrenches);
      const auto exact_dfd = generic::forward_dynamics_derivatives<Multi>(model, q, v, tau, F);
      EXPECT_LE(error(dfd.dq, exact_dfd.dq), limit) << robot;
      EXPECT_LE(error(dfd.dv, exact_dfd.dv), limit) << robot;
    }
  }
}

// A free body pushed off its centre: v̇ by Newton's and Euler's laws.
TEST(GenericForwardDynamics, FreeBodyMatchesNewtonAndEuler) {
  generic::Model<double> model;
  model.floating_base = true;
  model.gravity = {0, 0, -9.81};
  model.base = {2, {0, 0, 0}, Eigen::Vector3d(0.1, 0.2, 0.25).asDiagonal()};
  Eigen::VectorXd q(7), v(6), wrench(6);
  q << 5, 6, 7, 0.5, 0.5, 0.5, 0.5;  // the body's y axis points up
  v << 1, 2, 3, 0.4, 0.5, 0.6;
  wrench << 3, -1, 2, 0.5, 0.25, -0.75;
  const Eigen::Vector3d u = v.head<3>(), w = v.tail<3>(), I(0.1, 0.2, 0.25);
  Eigen::VectorXd expected(6);
  expected << wrench.head<3>() / 2 - w.cross(u) - Eigen::Vector3d(0, 9.81, 0),
      I.cwiseInverse().asDiagonal() * (wrench.tail<3>() - w.cross(I.asDiagonal() * w));
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(6);
  EXPECT_LE((generic::forward_dynamics<double>(model, q, v, zero, wrench).value - expected).norm(), 1e-13);
  EXPECT_LE((generic::forward_dynamics<double>(model, q, v, wrench).value - expected).norm(), 1e-13);
}

// A leaf that weighs nothing: its joint moves no mass, whatever the others do.
TEST(GenericForwardDynamics, SaysWhichCoordinateMovesNoMass) {
  for (const bool floating : {false, true}) {
    generic::Model<double> model = to_generic<double>(tree_named("branch_below_base", floating), test_gravity);
    model.bodies.back().inertia = {};
    const int last = model.nv() - 1;
    const Setting<double> s = setting(model, false, 5);
    const auto v_dot = generic::forward_dynamics<double>(s.model, s.q, s.v, s.tau);
    EXPECT_FALSE(v_dot.status.ok());
    EXPECT_EQ(v_dot.status.coordinate, last);
    EXPECT_NEAR(v_dot.status.pivot, 0, 1e-15);
    EXPECT_EQ(v_dot.value.size(), 0);
    EXPECT_EQ(generic::inverse_mass_matrix<double>(s.model, s.q).status.coordinate, last);
    EXPECT_EQ(generic::inverse_mass_matrix<double>(s.model, s.q).value.size(), 0);
    const auto derivatives = generic::forward_dynamics_derivatives<double>(s.model, s.q, s.v, s.tau);
    EXPECT_EQ(derivatives.status.coordinate, last);
    EXPECT_EQ(derivatives.dq.size() + derivatives.dv.size(), 0);
    // Armature is mass enough.
    model.bodies.back().armature = 1e-3;
    EXPECT_TRUE(generic::forward_dynamics<double>(model, s.q, s.v, s.tau).status.ok());
  }
}

// Two joints about one axis with mass behind the second only: M has no zero on its diagonal, yet no inverse.
TEST(GenericForwardDynamics, NoticesWhatIsSingularButForRounding) {
  generic::Model<double> model;
  model.bodies.resize(2);
  for (auto& body : model.bodies) body.axis = Eigen::Vector3d(0.6, 0, 0.8);
  model.bodies[1].parent = 0;
  model.bodies[1].inertia = {0.7, {0.1, -0.3, 0.2}, Eigen::Vector3d(0.11, 0.13, 0.17).asDiagonal()};
  for (const double q : {0.1, 0.7, 1.9, 3.3}) {
    const auto status = generic::inverse_mass_matrix<double>(model, Eigen::Vector2d(q, 2 * q)).status;
    EXPECT_EQ(status.coordinate, 0);
    EXPECT_NEAR(status.pivot, 0, 1e-15);
  }
}

TEST(GenericForwardDynamics, NoticesWhatIsIndefinite) {
  generic::Model<double> model = to_generic<double>(tree_named("chain_7", false), test_gravity);
  model.bodies[6].inertia.mass = -1;
  model.bodies[6].inertia.inertia.setZero();
  const Setting<double> s = setting(model, false, 5);
  const auto status = generic::inverse_mass_matrix<double>(s.model, s.q).status;
  EXPECT_EQ(status.coordinate, 6);
  EXPECT_LT(status.pivot, 0);
}

// What is not a number is no positive pivot.
TEST(GenericForwardDynamics, NoticesWhatIsNoNumber) {
  const Setting<double> s = setting(to_generic<double>(tree_named("chain_7", false), test_gravity), false, 5);
  Eigen::VectorXd q = s.q;
  q[6] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(generic::forward_dynamics<double>(s.model, q, s.v, s.tau).status.ok());
}

// However small or large all of them are: forces are those of weights beside one.
TEST(GenericDynamics, WeightsOfConstraintsMatterByTheirRatio) {
  generic::Model<double> model;
  model.floating_base = true;
  model.base.mass = 3;
  model.base.inertia.setIdentity();
  model.gravity = {0, 0, -9.81};
  const VectorX<double> q = VectorX<double>::Unit(7, 6), v = VectorX<double>::Zero(6),
                        v_dot = VectorX<double>::LinSpaced(6, -1, 1);
  generic::Contact<double> weld, point;
  point.rows = 3, point.frame.translation = {0.3, 0.1, -0.2};
  const auto forces = [&](double size) {
    generic::ConstraintOptions<double> options;
    options.weights = size * VectorX<double>::LinSpaced(9, 1, 2);
    const auto result = generic::constrained_inverse_dynamics<double>(model, generic::Constraints<double>{weld, point}, q, v,
                                                                      v_dot, {0, 1, 2, 3, 4, 5}, {}, options);
    EXPECT_LT(result.residual, 1e-12);
    return result.forces;
  };
  const VectorX<double> expected = forces(1);
  for (const double size : {1e-308, 1e-30, 1e30, 8e307}) EXPECT_LT((forces(size) - expected).norm(), 1e-12 * expected.norm());
}

TEST(GenericDynamics, RefusesArgumentsOfWrongSize) {
  const Setting<double> s = setting(to_generic<double>(tree_named("chain_7", true), test_gravity), false, 5);
  const Eigen::VectorXd longer = Eigen::VectorXd::Zero(14);
  EXPECT_THROW(generic::inverse_dynamics<double>(s.model, s.q, s.v, s.v_dot, longer), std::invalid_argument);
  EXPECT_THROW(generic::inverse_dynamics_dq<double>(s.model, s.q, s.v, longer), std::invalid_argument);
  EXPECT_THROW(generic::inverse_dynamics_dv<double>(s.model, s.q, longer, s.v_dot), std::invalid_argument);
  EXPECT_THROW(generic::regressor<double>(s.model, s.q, s.v, longer), std::invalid_argument);
  EXPECT_THROW(generic::forward_dynamics<double>(s.model, s.q, s.v, longer), std::invalid_argument);
  EXPECT_THROW(generic::forward_dynamics<double>(s.model, s.q, s.v, s.tau, longer), std::invalid_argument);
  EXPECT_THROW(generic::forward_dynamics_dq<double>(s.model, longer.head(3), s.v, s.tau), std::invalid_argument);
  EXPECT_THROW(generic::forward_dynamics_dv<double>(s.model, s.q, s.v, longer), std::invalid_argument);
  EXPECT_THROW(generic::inverse_mass_matrix<double>(s.model, s.v), std::invalid_argument);
}

}  // namespace
}  // namespace dalembert::testing
