// The generic engine's contacts and loops to a hundred digits, on every test robot: rows against differences, what keeps to
// them against dense algebra.
#include <gtest/gtest.h>

#include <cstdlib>
#include <dalembert/generic/constraint_derivatives.hpp>

#include "identities.hpp"
#include "load_robot.hpp"
#include "reference/eigenvalues.hpp"
#include "scale.hpp"
#include "states.hpp"

namespace dalembert::testing {
namespace {

using generic::Axes;
using generic::Contact;

const Multi step("1e-30"), mu("1e-30");
constexpr double tolerance = 1e-25;

using Rows = generic::Constraints<Multi>;
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
    if (last < 1) return;
    // Of every type, between the last body and others: of its own limb, of another, and the base.
    const auto between = [&](int one, int other, std::vector<int> linear, std::vector<int> angular) {
      return generic::Loop<Multi>{{one, other}, {sole, tip}, std::move(linear), std::move(angular), Multi(0)};
    };
    const generic::Loop<Multi> rod{{last / 2, last}, {sole, tip}, {}, {}, Multi("0.6")};
    sets.push_back({{}, {rod}});
    sets.push_back({{}, {between(0, last, {0, 1, 2}, {0, 1})}});
    sets.push_back(
        {{{last, tip, 3, Axes::mixed}}, {between(-1, last / 2, {0, 1}, {0, 1}), between(last / 3, last, {2}, {0, 1})}});
    sets.push_back(
        {{{last, sole, 6, Axes::mixed}}, {between(last, last - 1, {0, 1}, {}), rod, between(0, last, {0, 1, 2}, {0, 1, 2})}});
  }

  Matrix jacobian(const Rows& contacts, const Vector& q) const {
    return generic::constraint_jacobian<Multi>(c.model, contacts, q);
  }
  // A hundred digits tell an M from a singular one that only the file's decimals keep from it; nobody solves with that.
  bool is_singular() const {
    Eigen::MatrixXd M = generic::mass_matrix<Multi>(c.model, c.q).cast<double>();
    if (!(M.diagonal().minCoeff() > 0)) return true;
    const Eigen::VectorXd scale = M.diagonal().cwiseSqrt().cwiseInverse();
    M = scale.asDiagonal() * M * scale.asDiagonal();
    return reference::eigenvalues(M).minCoeff() < 1e-13;
  }
  // Rows that only the file's decimals keep from depending on each other: no number of proximal steps tells which they are.
  bool are_doubtful(const Rows& contacts) const {
    const Matrix J = jacobian(contacts, c.q),
                 along = J * generic::inverse_mass_matrix<Multi>(c.model, c.q).value * J.transpose();
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
  std::vector<Rows> sets;
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
    Eigen::Index row = 0;
    for (const auto& [own, linear] : contacts.rows()) {
      for (int begin = 0, end = linear; begin < own; begin = end, end = own) {
        const Multi mean =
            along.diagonal().segment(row + begin, end - begin).sum() / (end - begin) + Multi(1e-6) * along.trace();
        weight.segment(row + begin, end - begin).setConstant(1 / sqrt(mean > 0 ? mean : Multi(1)));
      }
      row += own;
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

// Where b's point is as a sees it, and its distance, whatever else moves: J is their gradient, closed or not.
TEST_P(Constraints, ALoopsRowsAreTheRatesOfWhatTheyHold) {
  const auto held = [&](const generic::Loop<Multi>& loop, const Vector& q) -> Vector {
    const Vector rest = Vector::Zero(c.v.size());
    const generic::detail::State<Multi> at(c.model, q, rest);
    const generic::detail::LoopFrames<Multi> frames(c.model, at, loop, false);
    const Vector3<Multi> between = frames.between();
    if (loop.distance > 0)
      return Vector::Constant(1, (between.squaredNorm() - loop.distance * loop.distance) / (2 * loop.distance));
    const Vector3<Multi> along = frames.poses[0].rotation.transpose() * between;
    Vector rows(loop.linear_rows());
    for (size_t i = 0; i < loop.linear.size(); ++i) rows[static_cast<Eigen::Index>(i)] = along[loop.linear[i]];
    return rows;
  };
  for (const auto& constraints : sets)
    for (const generic::Loop<Multi>& loop : constraints.loops) {
      const Vector before = held(loop, integrate(c.model, c.q, c.v, -step)),
                   after = held(loop, integrate(c.model, c.q, c.v, step)), rate = (after - before) / (2 * step),
                   velocity = jacobian({{}, {loop}}, c.q) * c.v;
      EXPECT_LT(relative_error(velocity.head(loop.linear_rows()), rate, std::max<Multi>(largest(rate), Multi(1))), tolerance);
    }
}

// The base, and what has no motor, is borne by the constraints, with the least forces; the robot moves as it was asked to, as
// far as its constraints let it.
TEST_P(Constraints, InverseDynamicsLeavesNothingToWhatHasNoMotor) {
  if (is_singular()) GTEST_SKIP() << "M is singular";
  generic::ConstraintOptions<Multi> options;
  options.mu = mu;
  const bool floating = std::get<1>(GetParam());
  std::vector<int> undriven;
  for (int j = 0; j < (floating ? 6 : 0); ++j) undriven.push_back(j);
  if (!floating) undriven.push_back(static_cast<int>(c.v.size()) - 1);
  const Vector wanted = c.v.reverse() * Multi("0.7");
  for (const auto& constraints : sets) {
    if (are_doubtful(constraints)) continue;
    const auto result =
        generic::constrained_inverse_dynamics<Multi>(c.model, constraints, c.q, c.v, wanted, undriven, {}, options);
    const Matrix J = jacobian(constraints, c.q);
    const Vector balance = generic::inverse_dynamics<Multi>(c.model, c.q, c.v, wanted);
    EXPECT_LT(relative_error(Vector(result.value + J.transpose() * result.forces), balance, largest(balance)), tolerance);
    Matrix own(J.rows(), static_cast<Eigen::Index>(undriven.size()));
    Vector lacking(own.cols());
    for (Eigen::Index i = 0; i < own.cols(); ++i) {
      own.col(i) = J.col(undriven[static_cast<size_t>(i)]);
      lacking[i] = balance[undriven[static_cast<size_t>(i)]];
    }
    Eigen::CompleteOrthogonalDecomposition<Matrix> support(own.transpose().rows(), own.rows());
    support.setThreshold(Multi("1e-12"));
    support.compute(own.transpose());
    if (support.rank() < own.cols()) continue;  // it cannot be borne
    EXPECT_LT(result.residual.convert_to<double>(), 1e-20 * largest(balance).convert_to<double>());
    const Vector least = support.solve(lacking);
    EXPECT_LT(relative_error(result.forces, least, largest(least)), tolerance);
    const auto moved = generic::constrained_forward_dynamics<Multi>(c.model, constraints, c.q, c.v, result.value, {}, options);
    const Matrix inverse = generic::inverse_mass_matrix<Multi>(c.model, c.q).value, along = J * inverse * J.transpose();
    Eigen::CompleteOrthogonalDecomposition<Matrix> rows(J.rows(), J.rows());
    rows.setThreshold(Multi("1e-12"));
    rows.compute(along);
    if (rows.rank() < J.rows()) continue;
    const Vector right = -generic::constraint_bias<Multi>(c.model, constraints, c.q, c.v), rest = right - J * wanted,
                 nearest = wanted + inverse * (J.transpose() * rows.solve(rest));
    EXPECT_LT(relative_error(moved.value, nearest, std::max<Multi>(largest(nearest), largest(wanted))), tolerance);
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

// Of v̇ and of forces, along the tangent, with a constraint masked and rows that give way, too. Large robots, which take
// minutes, where DALEMBERT_LARGE_ROBOTS is set: tests/long.sh. The largest would take hours.
TEST_P(Constraints, DerivativesAreDifferences) {
  if (c.v.size() > (std::getenv("DALEMBERT_LARGE_ROBOTS") ? 55 : 10)) return;
  if (is_singular()) GTEST_SKIP() << "M is singular";
  for (size_t set = 0; set < sets.size(); ++set) {
    SCOPED_TRACE(set);
    const Rows& constraints = sets[set];
    if (are_doubtful(constraints)) continue;
    const Matrix J = jacobian(constraints, c.q), inverse = generic::inverse_mass_matrix<Multi>(c.model, c.q).value;
    Eigen::CompleteOrthogonalDecomposition<Matrix> rows(J.rows(), J.rows());
    rows.setThreshold(Multi("1e-12"));
    rows.compute(J * inverse * J.transpose());
    generic::ConstraintOptions<Multi> options;
    options.mu = mu;
    // Where rows depend on each other at this posture alone there is no derivative: there they give way.
    if (rows.rank() < J.rows() || set % 3 == 2) options.regularization = Vector::Constant(J.rows(), Multi("0.3"));
    if (set % 2 == 1) {
      options.active.assign(constraints.rows().size(), true);
      options.active.back() = set == 1;
    }
    const auto motion = [&](const Vector& q, const Vector& v, const Vector& efforts) -> Vector {
      const auto result = generic::constrained_forward_dynamics<Multi>(c.model, constraints, q, v, efforts, {}, options);
      Vector both(result.value.size() + result.forces.size());
      both << result.value, result.forces;
      return both;
    };
    const auto result = generic::constrained_derivatives<Multi>(c.model, constraints, c.q, c.v, tau, {}, options);
    const Eigen::Index n = c.v.size();
    Matrix by_q(n + J.rows(), n), by_v = by_q, by_tau = by_q;
    for (Eigen::Index k = 0; k < n; ++k) {
      const Vector unit = Vector::Unit(n, k);
      const auto difference = [&](const Vector& more, const Vector& less) -> Vector { return (more - less) / (2 * step); };
      by_q.col(k) = difference(motion(integrate(c.model, c.q, unit, step), c.v, tau),
                               motion(integrate(c.model, c.q, unit, -step), c.v, tau));
      by_v.col(k) = difference(motion(c.q, c.v + step * unit, tau), motion(c.q, c.v - step * unit, tau));
      by_tau.col(k) = difference(motion(c.q, c.v, tau + step * unit), motion(c.q, c.v, tau - step * unit));
    }
    const auto compare = [&](const char* what, const Matrix& value, const Matrix& forces, const Matrix& expected) {
      SCOPED_TRACE(what);
      Matrix all(expected.rows(), n);
      all << value, forces;
      const Multi least = largest(expected);
      EXPECT_LT(relative_error(Matrix(all.topRows(n)), Matrix(expected.topRows(n)), least), tolerance);
      EXPECT_LT(relative_error(forces, Matrix(expected.bottomRows(J.rows())), least), tolerance);
    };
    compare("q", result.dq, result.forces_dq, by_q);
    compare("v", result.dv, result.forces_dv, by_v);
    compare("tau", result.dtau, result.forces_dtau, by_tau);
  }
}

// A contact that does not act is none: not even by a digit of the hundred.
TEST_P(Constraints, AMaskedContactIsNone) {
  if (!generic::inverse_mass_matrix<Multi>(c.model, c.q).status.ok()) GTEST_SKIP() << "M is singular";
  const std::vector<Contact<Multi>>& all = sets[3].contacts;
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
