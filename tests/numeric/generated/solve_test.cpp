// Compiled code that factors M and solves with it, joints being driven by one of another limb: M = U D U', any number of
// right-hand sides, forward dynamics and its derivatives, and an M that is singular.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "factors/c_api.h"
#include "factors/dynamics.hpp"
#include "factors/tasks.hpp"
#include "heap_count.hpp"
#include "pipeline.hpp"
#include "reference/engine.hpp"
#include "singular_driven/dynamics.hpp"
#include "singular_factors/dynamics.hpp"
#include "states.hpp"

namespace dalembert::testing {
namespace {

using factors::nv;
using Columns = Eigen::Matrix<double, nv, Eigen::Dynamic>;

class Solve : public ::testing::Test {
 protected:
  Solve() {
    Request request;
    request.robot = ROBOT;
    request.settings = {
        {"base", "floating"},
        {"mimic", "{e_02_joint: {of: c_01_joint, multiplier: -0.7, offset: 0.1}, f_01_joint: {of: b_01_joint}}"}};
    Diagnostics warnings;
    model = read_model(request, warnings);
    const State state = moderate_state(model.tree, 5);
    q = state.q, v = state.v, tau = moderate_state(model.tree, 6).v;
    factors::evaluate(q, v, workspace);
    tolerance = 10 * reference::mass_condition(model.tree, model.scene, {q, v, tau}) * 0x1p-53;
  }

  double error(ir::Quantity quantity, const Eigen::MatrixXd& result) const {
    const Eigen::MatrixXd right =
        reference::evaluate(model.tree, model.scene, {{quantity, ""}}, {q, v, tau}, reference::Precision::float64).front();
    return (result - right).cwiseAbs().maxCoeff<Eigen::PropagateNaN>() / right.cwiseAbs().maxCoeff();
  }

  Model model;
  factors::VectorQ q;
  factors::VectorV v, tau;
  factors::Workspace workspace;
  double tolerance = 0;
};

double largest(const Eigen::MatrixXd& x) { return x.cwiseAbs().maxCoeff<Eigen::PropagateNaN>(); }

TEST_F(Solve, TheFactorsMakeM) {
  Eigen::MatrixXd upper = factors::mass_matrix_factor(workspace);
  EXPECT_TRUE(workspace.status.ok());
  EXPECT_EQ(largest(upper.triangularView<Eigen::StrictlyLower>().toDenseMatrix()), 0);
  const Eigen::VectorXd pivots = upper.diagonal();
  EXPECT_GT(pivots.minCoeff(), 0);
  upper.diagonal().setOnes();
  const Eigen::MatrixXd M = factors::mass_matrix(workspace);
  EXPECT_LE(largest(upper * pivots.asDiagonal() * upper.transpose() - M), 1e-14 * largest(M));
  // Limb c drives a joint beyond e's, which so is tied to it; to limb d it is not, neither in M nor in the factors.
  const auto at = factors::v_index;
  EXPECT_NE(upper(at(factors::Joint::c_01_joint), at(factors::Joint::e_01_joint)), 0);
  EXPECT_EQ(upper(at(factors::Joint::d_02_joint), at(factors::Joint::e_01_joint)), 0);
}

TEST_F(Solve, AnyNumberOfColumns) {
  const Eigen::MatrixXd M = factors::mass_matrix(workspace);
  for (const int columns : {1, 2, 3, 7, 8, 9, 16, 23}) {
    const Columns b = Columns::Random(nv, columns);
    Columns x = b;
    EXPECT_TRUE(factors::solve(x, workspace));
    EXPECT_LE(largest(x - M.inverse() * b), tolerance * largest(x)) << columns;
  }
}

TEST_F(Solve, ColumnsOfALargerMatrixAndVectors) {
  Eigen::MatrixXd whole = Eigen::MatrixXd::Random(nv + 3, 6);
  const Eigen::MatrixXd before = whole, M = factors::mass_matrix(workspace);
  EXPECT_TRUE(factors::solve(whole.block(2, 1, nv, 4), workspace));
  EXPECT_LE(largest(M * whole.block(2, 1, nv, 4) - before.block(2, 1, nv, 4)), tolerance * largest(M) * largest(whole));
  whole.block(2, 1, nv, 4) = before.block(2, 1, nv, 4);
  EXPECT_EQ(whole, before);
  factors::VectorV x = tau;
  EXPECT_TRUE(factors::solve(x, workspace));
  EXPECT_LE(largest(x - M.inverse() * tau), tolerance * largest(x));
  double c[2 * nv];
  std::copy(tau.begin(), tau.end(), c);
  std::copy(tau.begin(), tau.end(), c + nv);
  factors_workspace* const handle = factors_create();
  factors_evaluate(q.data(), v.data(), handle);
  EXPECT_EQ(factors_solve(c, 2, handle), 1);
  factors_destroy(handle);
  for (int i = 0; i < nv; ++i) {
    EXPECT_NEAR(c[i], x[i], tolerance * largest(x));
    EXPECT_EQ(c[i], c[nv + i]);
  }
}

TEST_F(Solve, ForwardDynamicsIsUndoneByInverseDynamics) {
  factors::forward_dynamics(q, v, tau, workspace);
  const factors::VectorV acceleration = factors::forward_dynamics(workspace);
  const Eigen::MatrixXd right = reference::evaluate(model.tree, model.scene, {{ir::Quantity::forward_dynamics, ""}},
                                                    {q, v, tau}, reference::Precision::float64)
                                    .front();
  EXPECT_LE(largest(acceleration - right), tolerance * largest(right));
  factors::inverse_dynamics(q, v, acceleration, workspace);
  EXPECT_LE(largest(factors::inverse_dynamics(workspace) - tau), tolerance * largest(tau));
}

TEST_F(Solve, DerivativesAreTheGenericEnginesAndDifferences) {
  factors::forward_dynamics(q, v, tau, workspace);
  factors::plan(q, v, tau, workspace);
  factors::lean(q, v, tau, workspace);
  EXPECT_TRUE(workspace.forward_dynamics_status.ok() && workspace.plan_status.ok() && workspace.lean_status.ok());
  const Eigen::MatrixXd by_q = factors::forward_dynamics_dq(workspace), by_v = factors::forward_dynamics_dv(workspace);
  EXPECT_LE(error(ir::Quantity::forward_dynamics, factors::forward_dynamics(workspace)), tolerance);
  EXPECT_LE(error(ir::Quantity::forward_dynamics_dq, by_q), tolerance);
  EXPECT_LE(error(ir::Quantity::forward_dynamics_dv, by_v), tolerance);
  EXPECT_LE(error(ir::Quantity::forward_dynamics_dq, factors::plan_forward_dynamics_dq(workspace)), tolerance);
  EXPECT_LE(error(ir::Quantity::forward_dynamics_dv, factors::lean_forward_dynamics_dv(workspace)), tolerance);
  constexpr double h = 1e-5;
  const auto difference = [&](double& coordinate) -> factors::VectorV {
    const double at = coordinate;
    coordinate = at + h;
    factors::forward_dynamics(q, v, tau, workspace);
    const factors::VectorV above = factors::forward_dynamics(workspace);
    coordinate = at - h;
    factors::forward_dynamics(q, v, tau, workspace);
    coordinate = at;
    return (above - factors::forward_dynamics(workspace)) / (2 * h);
  };
  for (int i = 0; i < nv; ++i) {
    EXPECT_LE(largest(difference(v[i]) - by_v.col(i)), 1e-7 * largest(by_v)) << i;
    const int joint = i - (nv - factors::joints);
    if (joint < 0) continue;
    EXPECT_LE(largest(difference(q[factors::nq - factors::joints + joint]) - by_q.col(i)), 1e-7 * largest(by_q)) << i;
  }
}

TEST_F(Solve, BothHalvesOfAFunctionStandInItsTaskGraph) {
  factors::forward_dynamics(q, v, tau, workspace);
  factors::plan(q, v, tau, workspace);
  static factors::Workspace by_tasks;
  factors::ForwardDynamicsTaskGraph graph(by_tasks);
  graph.forward_dynamics(q.data(), v.data(), tau.data());
  factors::PlanTaskGraph plan(by_tasks);
  plan.plan(q.data(), v.data(), tau.data());
  EXPECT_EQ(factors::forward_dynamics(by_tasks), factors::forward_dynamics(workspace));
  EXPECT_EQ(factors::forward_dynamics_dq(by_tasks), factors::forward_dynamics_dq(workspace));
  EXPECT_EQ(factors::forward_dynamics_dv(by_tasks), factors::forward_dynamics_dv(workspace));
  EXPECT_EQ(factors::plan_forward_dynamics_dq(by_tasks), factors::plan_forward_dynamics_dq(workspace));
}

// Its results are its own, and it solves by its own factors.
TEST_F(Solve, AFunctionOfTheSceneSolvesToo) {
  factors::step(q, v, tau, workspace);
  factors::VectorV x = tau;
  EXPECT_TRUE(factors::step_solve(x, workspace));
  factors::VectorV y = tau;
  factors::solve(y, workspace);
  EXPECT_LE(largest(x - y), tolerance * largest(x));
  factors::forward_dynamics(q, v, tau, workspace);
  const factors::VectorV expected = factors::forward_dynamics(workspace);
  EXPECT_LE(largest(factors::step_forward_dynamics(workspace) - expected), tolerance * largest(expected));
}

TEST_F(Solve, NothingIsHandedOnBeforeThereAreFactors) {
  factors::Workspace unused;
  Columns x = Columns::Random(nv, 3);
  EXPECT_FALSE(factors::solve(x, unused));
  EXPECT_EQ(largest(x), 0);
}

TEST_F(Solve, ColumnsOfAnotherLengthAreLeftAlone) {
  static_assert(std::is_same_v<decltype(factors::solve(tau, workspace)), bool>);
  for (const int rows : {0, nv - 1, nv + 1}) {
    Eigen::MatrixXd b = Eigen::MatrixXd::Ones(rows, 3);
    EXPECT_FALSE(factors::solve(b, workspace)) << rows;
    EXPECT_TRUE((b.array() == 1).all());
    Eigen::VectorXd x = Eigen::VectorXd::Ones(rows);
    EXPECT_FALSE(factors::solve(x, workspace)) << rows;
    EXPECT_TRUE((x.array() == 1).all());
  }
  Eigen::VectorXd x = tau;
  EXPECT_TRUE(factors::solve(x, workspace));
  factors::VectorV expected = tau;
  factors::solve(expected, workspace);
  EXPECT_EQ(x, expected);
}

TEST_F(Solve, DoesNotAllocate) {
  Columns x = Columns::Random(nv, 11);
  const std::uint64_t before = heap_allocations();
  factors::evaluate(q, v, workspace);
  factors::forward_dynamics(q, v, tau, workspace);
  factors::plan(q, v, tau, workspace);
  factors::solve(x, workspace);
  EXPECT_EQ(heap_allocations() - before, 0u);
}

TEST_F(Solve, ASingularMassMatrixIsToldAndNothingHandedOn) {
  static singular_factors::Workspace singular;
  double position[singular_factors::nq] = {0, 0, 0, 0, 0, 0, 1, 0.3, -0.4}, rate[singular_factors::nv] = {};
  Eigen::Matrix<double, singular_factors::nv, 3> b;
  const auto run = [&] {
    b.setOnes();
    singular_factors::evaluate(position, rate, singular);
    singular_factors::forward_dynamics(position, rate, b.data(), singular);
    return singular_factors::solve(b, singular);
  };
  EXPECT_FALSE(run());
  EXPECT_EQ(singular.status.coordinate, 7);
  EXPECT_EQ(singular.forward_dynamics_status.coordinate, 7);
  EXPECT_EQ(largest(b), 0);
  EXPECT_EQ(largest(singular_factors::mass_matrix_factor(singular)), 0);
  EXPECT_EQ(largest(singular_factors::inverse_mass_matrix(singular)), 0);
  EXPECT_EQ(largest(singular_factors::forward_dynamics(singular)), 0);
  singular.payload_c.mass = 1;
  singular.payload_c.com[0] = 0.1;
  EXPECT_TRUE(run());
  EXPECT_TRUE(singular.status.ok() && singular.forward_dynamics_status.ok());
  EXPECT_TRUE(b.allFinite() && largest(b) > 0);
  singular.payload_c.mass = std::nan("");
  EXPECT_FALSE(run());
  EXPECT_EQ(largest(b), 0);
}

// What the section behind computes is zero as well.
TEST_F(Solve, ASingularMassMatrixHasNoDerivatives) {
  static singular_driven::Workspace singular;
  const double position[singular_driven::nq] = {0, 0, 0, 0, 0, 0, 1, 0.3};
  double rate[singular_driven::nv], force[singular_driven::nv];
  std::fill(std::begin(rate), std::end(rate), 0.5);
  std::fill(std::begin(force), std::end(force), 1.0);
  const auto run = [&](double mass) {
    singular.payload_c.mass = mass;
    singular_driven::forward_dynamics(position, rate, force, singular);
    return largest(singular_driven::forward_dynamics_dq(singular)) + largest(singular_driven::forward_dynamics_dv(singular));
  };
  singular.payload_c.com[0] = 0.1;
  EXPECT_GT(run(1), 0);
  EXPECT_TRUE(singular.forward_dynamics_status.ok());
  for (const double mass : {-500.0, std::nan("")}) {
    EXPECT_EQ(run(mass), 0);
    EXPECT_FALSE(singular.forward_dynamics_status.ok());
  }
}

}  // namespace
}  // namespace dalembert::testing
