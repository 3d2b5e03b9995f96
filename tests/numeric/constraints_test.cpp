// The generic engine's contacts to a hundred digits, on every test robot: rows against differences, what keeps to them against
// dense algebra.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <dalembert/generic/constraints.hpp>

#include "identities.hpp"
#include "load_robot.hpp"
#include "scale.hpp"
#include "states.hpp"

namespace dalembert::testing {
namespace {

using generic::Axes;
using generic::Contact;

const Multi step("1e-30"), mu("1e-30");
constexpr double tolerance = 1e-25;

using RobotAndBase = std::tuple<TestRobot, bool>;

class Constraints : public ::testing::TestWithParam<RobotAndBase> {
 protected:
  Constraints() {
    const auto [robot, floating] = GetParam();
    const ir::KinematicTree tree = load_robot(robot, floating);
    const State state = moderate_state(tree, 1);
    c = {exact_model(tree, test_gravity), exact_position(tree, state.q), state.v.cast<Multi>()};
    tau = state.v.reverse().cast<Multi>() * Multi(3);
    const int last = c.model.joints() - 1;
    const Transform<Multi> sole{rotation_about<Multi>(Vector3<Multi>(1, 2, -2) / 3, Multi("0.7")),
                                {Multi("0.1"), Multi("-0.2"), Multi("0.3")}};
    const Transform<Multi> tip{Matrix3<Multi>::Identity(), {Multi("-0.05"), Multi("0.3"), Multi("0.02")}};
    sets = {{{last, sole, 6, Axes::mixed}},
            {{last, tip, 3, Axes::body}},
            {{last / 2, tip, 3, Axes::mixed}, {last, sole, 6, Axes::body}},
            {{last, sole, 6, Axes::mixed},
             {last / 3, sole, 6, Axes::mixed},
             {last, tip, 3, Axes::mixed},
             {last / 2, tip, 3, Axes::body}}};
    if (floating) sets.push_back({{-1, sole, 6, Axes::mixed}, {last, tip, 3, Axes::mixed}});
  }

  Matrix jacobian(const std::vector<Contact<Multi>>& contacts, const Vector& q) const {
    return generic::constraint_jacobian<Multi>(c.model, contacts, q);
  }
  // A hundred digits tell an M from a singular one that only the file's decimals keep from it; nobody solves with that.
  bool is_singular() const {
    Eigen::MatrixXd M = generic::mass_matrix<Multi>(c.model, c.q).cast<double>();
    if (!(M.diagonal().minCoeff() > 0)) return true;
    const Eigen::VectorXd scale = M.diagonal().cwiseSqrt().cwiseInverse();
    M = scale.asDiagonal() * M * scale.asDiagonal();
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(M, Eigen::EigenvaluesOnly).eigenvalues().minCoeff() < 1e-13;
  }
  // Rows that only the file's decimals keep from depending on each other: no number of proximal steps tells which they are.
  bool are_doubtful(const std::vector<Contact<Multi>>& contacts) const {
    const Matrix J = jacobian(contacts, c.q), along = J * generic::inverse_mass_matrix<Multi>(c.model, c.q).value * J.transpose();
    const auto rank = [&](const char* threshold) {
      Eigen::CompleteOrthogonalDecomposition<Matrix> rows(along.rows(), along.cols());
      rows.setThreshold(Multi(threshold));
      rows.compute(along);
      return rows.rank();
    };
    return rank("1e-12") != rank("1e-60");
  }
  Vector accelerations(const Vector& efforts) const {
    return generic::forward_dynamics<Multi>(c.model, c.q, c.v, efforts).value;
  }

  Case c;
  Vector tau;
  std::vector<std::vector<Contact<Multi>>> sets;
};

TEST_P(Constraints, BiasIsTheRateOfTheRowsVelocities) {
  for (const auto& contacts : sets) {
    const Vector before = jacobian(contacts, integrate(c.model, c.q, c.v, -step)) * c.v,
                 after = jacobian(contacts, integrate(c.model, c.q, c.v, step)) * c.v, rate = (after - before) / (2 * step),
                 bias = generic::constraint_bias<Multi>(c.model, contacts, c.q, c.v);
    EXPECT_LT(relative_error(bias, rate, std::max<Multi>(largest(rate), Multi(1))), tolerance);
  }
}

// With the rows in units of N, as proximal steps see them: where they contradict each other, the least squares of what is left.
TEST_P(Constraints, AccelerationsAndForcesAreThoseOfDenseAlgebra) {
  generic::ConstraintOptions<Multi> options;
  options.mu = mu;
  if (is_singular()) GTEST_SKIP() << "M is singular";
  const Matrix inverse = generic::inverse_mass_matrix<Multi>(c.model, c.q).value;
  for (const auto& contacts : sets) {
    if (are_doubtful(contacts)) continue;
    const auto result = generic::constrained_forward_dynamics<Multi>(c.model, contacts, c.q, c.v, tau, {}, options);
    const Matrix J = jacobian(contacts, c.q), along = J * inverse * J.transpose();
    const Vector free = accelerations(tau), right = -generic::constraint_bias<Multi>(c.model, contacts, c.q, c.v);
    Vector weight(J.rows());
    for (Eigen::Index r = 0; r < J.rows(); r += 3) {
      const Multi mean = along.diagonal().segment(r, 3).sum() / 3 + Multi(1e-6) * along.trace();
      weight.segment(r, 3).setConstant(1 / sqrt(mean));
    }
    Eigen::CompleteOrthogonalDecomposition<Matrix> rows(J.rows(), J.rows());
    rows.setThreshold(Multi("1e-12"));
    rows.compute(weight.asDiagonal() * along * weight.asDiagonal());
    const Vector rest = weight.asDiagonal() * (right - J * free), solved = rows.solve(rest);
    const Vector forces = weight.asDiagonal() * solved, expected = free + inverse * (J.transpose() * forces);
    // What contacts keep down is as wrong as what there were without them.
    EXPECT_LT(relative_error(result.value, expected, std::max<Multi>(largest(expected), largest(free))), tolerance);
    if (rows.rank() < J.rows()) continue;
    EXPECT_LT(relative_error(result.forces, forces, largest(forces)), tolerance);
    EXPECT_LT(relative_error(J * result.value, right, std::max<Multi>(largest(right), Multi(1))), tolerance);
    // What the robot is given and what the contacts give it make the motion.
    const Vector balance = generic::inverse_dynamics<Multi>(c.model, c.q, c.v, result.value);
    EXPECT_LT(relative_error(balance, Vector(tau + J.transpose() * result.forces), largest(balance)), tolerance);
  }
}

TEST_P(Constraints, AnImpactStopsTheRows) {
  generic::ConstraintOptions<Multi> options;
  options.mu = mu;
  if (is_singular()) GTEST_SKIP() << "M is singular";
  for (const auto& contacts : sets) {
    if (are_doubtful(contacts)) continue;
    const auto after = generic::impact<Multi>(c.model, contacts, c.q, c.v, options);
    const Matrix J = jacobian(contacts, c.q);
    EXPECT_LT(largest(J * after.value).convert_to<double>(), 1e-20);
    // It takes energy: v' M v - v+' M v+ is the square of what is lost.
    const Matrix M = generic::mass_matrix<Multi>(c.model, c.q);
    const Vector lost = c.v - after.value;
    const Multi before = c.v.dot(M * c.v), now = after.value.dot(M * after.value), taken = lost.dot(M * lost);
    EXPECT_LT(abs(before - now - taken).convert_to<double>(), 1e-20 * before.convert_to<double>());
  }
}

// A contact that does not act is none: not even by a digit of the hundred.
TEST_P(Constraints, AMaskedContactIsNone) {
  if (!generic::inverse_mass_matrix<Multi>(c.model, c.q).status.ok()) GTEST_SKIP() << "M is singular";
  const std::vector<Contact<Multi>>& all = sets[3];
  generic::ConstraintOptions<Multi> options;
  options.active = {true, false, true, false};
  const auto masked = generic::constrained_forward_dynamics<Multi>(c.model, all, c.q, c.v, tau, {}, options);
  const auto without = generic::constrained_forward_dynamics<Multi>(c.model, {all[0], all[2]}, c.q, c.v, tau);
  EXPECT_LT(relative_error(masked.value, without.value, largest(without.value)), 1e-60);
  EXPECT_EQ(largest(masked.forces.segment(6, 6)), 0);
  EXPECT_EQ(largest(masked.forces.tail(3)), 0);
}

INSTANTIATE_TEST_SUITE_P(Robots, Constraints, ::testing::Combine(::testing::ValuesIn(test_robots), ::testing::Bool()),
                         [](const auto& info) {
                           return std::string(std::get<0>(info.param).name) +
                                  (std::get<1>(info.param) ? "_floating" : "_fixed");
                         });

}  // namespace
}  // namespace dalembert::testing
