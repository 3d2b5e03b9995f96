// Compiled code of the functions beside evaluate(), standard ones and those that a scene names: each computes its own outputs
// and nothing else, serially and as tasks, without the heap; and a mass matrix that cannot be solved with is told, not handed
// on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

#include "functions/c_api.h"
#include "functions/dynamics.hpp"
#include "functions/tasks.hpp"
#include "heap_count.hpp"
#include "pipeline.hpp"
#include "reference/engine.hpp"
#include "singular/c_api.h"
#include "singular/dynamics.hpp"
#include "singular_rolled/dynamics.hpp"
#include "states.hpp"

namespace dalembert::testing {
namespace {

using functions::Workspace;

struct Input {
  functions::VectorQ q;
  functions::VectorV v, more;
};

class Functions : public ::testing::Test {
 protected:
  Functions() {
    Request request;
    request.robot = ROBOT;
    request.settings = {{"base", "floating"}};
    Diagnostics warnings;
    model = read_model(request, warnings);
  }
  Input input(std::uint64_t seed) const {
    const State state = moderate_state(model.tree, seed);
    return {state.q, state.v, moderate_state(model.tree, seed + 100).v};
  }
  // Of the result, relative to its largest element in the generic engine.
  template <class Result>
  double error(ir::Quantity quantity, const Input& at, const Result& result) const {
    const Eigen::MatrixXd right =
        reference::evaluate(model.tree, model.scene, {{quantity, ""}}, {at.q, at.v, at.more}, reference::Precision::float64)
            .front();
    return (result - right).cwiseAbs().template maxCoeff<Eigen::PropagateNaN>() / right.cwiseAbs().maxCoeff();
  }
  double solved_tolerance(const Input& at) const {
    return 10 * reference::mass_condition(model.tree, model.scene, {at.q, at.v, at.more}) * 0x1p-53;
  }

  Model model;
};

template <std::size_t n>
bool all_zero(const double (&numbers)[n]) {
  return std::all_of(std::begin(numbers), std::end(numbers), [](double x) { return x == 0; });
}

TEST_F(Functions, ComputeWhatTheGenericEngineDoes) {
  Workspace workspace;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Input at = input(seed);
    functions::evaluate(at.q, at.v, workspace);
    functions::inverse_dynamics(at.q, at.v, at.more, workspace);
    functions::forward_dynamics(at.q, at.v, at.more, workspace);
    EXPECT_LE(error(ir::Quantity::inverse_dynamics, at, functions::inverse_dynamics(workspace)), 1e-12);
    EXPECT_LE(error(ir::Quantity::inverse_dynamics_dq, at, functions::inverse_dynamics_dq(workspace)), 1e-12);
    EXPECT_LE(error(ir::Quantity::inverse_dynamics_dv, at, functions::inverse_dynamics_dv(workspace)), 1e-12);
    EXPECT_LE(error(ir::Quantity::regressor, at, functions::regressor(workspace)), 1e-12);
    const double tolerance = solved_tolerance(at);
    EXPECT_LE(error(ir::Quantity::inverse_mass_matrix, at, functions::inverse_mass_matrix(workspace)), tolerance);
    EXPECT_LE(error(ir::Quantity::forward_dynamics, at, functions::forward_dynamics(workspace)), tolerance);
    EXPECT_LE(error(ir::Quantity::forward_dynamics_dq, at, functions::forward_dynamics_dq(workspace)), tolerance);
    EXPECT_LE(error(ir::Quantity::forward_dynamics_dv, at, functions::forward_dynamics_dv(workspace)), tolerance);
    EXPECT_TRUE(workspace.status.ok() && workspace.forward_dynamics_status.ok());
  }
}

TEST_F(Functions, ForwardDynamicsIsUndoneByInverseDynamics) {
  Workspace workspace;
  const Input at = input(7);
  functions::forward_dynamics(at.q, at.v, at.more, workspace);
  const functions::VectorV acceleration = functions::forward_dynamics(workspace);
  functions::inverse_dynamics(at.q, at.v, acceleration, workspace);
  EXPECT_LE((functions::inverse_dynamics(workspace) - at.more).cwiseAbs().maxCoeff(),
            solved_tolerance(at) * at.more.cwiseAbs().maxCoeff());
}

TEST_F(Functions, LeaveOutputsOfOthersAlone) {
  const Input at = input(3);
  Workspace evaluated, inverse, forward;
  functions::evaluate(at.q, at.v, evaluated);
  EXPECT_TRUE(all_zero(evaluated.inverse_dynamics) && all_zero(evaluated.forward_dynamics));
  functions::inverse_dynamics(at.q, at.v, at.more, inverse);
  EXPECT_TRUE(all_zero(inverse.inverse_mass_matrix) && all_zero(inverse.forward_dynamics));
  functions::forward_dynamics(at.q, at.v, at.more, forward);
  EXPECT_TRUE(all_zero(forward.inverse_mass_matrix) && all_zero(forward.inverse_dynamics));
  EXPECT_FALSE(all_zero(forward.forward_dynamics));
}

TEST_F(Functions, OfTheSceneComputeWhatTheGenericEngineDoes) {
  Workspace workspace;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Input at = input(seed);
    functions::balance(at.q, at.v, workspace);
    functions::track(at.q, at.v, at.more, workspace);
    functions::plan(at.q, at.v, at.more, workspace);
    EXPECT_LE(error(ir::Quantity::mass_matrix, at, functions::balance_mass_matrix(workspace)), 1e-12);
    EXPECT_LE(error(ir::Quantity::momentum_matrix, at, functions::balance_momentum_matrix(workspace)), 1e-12);
    EXPECT_LE(error(ir::Quantity::coriolis_matrix, at, functions::track_coriolis_matrix(workspace)), 1e-12);
    EXPECT_LE(error(ir::Quantity::bias, at, functions::track_bias(workspace)), 1e-12);
    EXPECT_LE(error(ir::Quantity::inverse_dynamics, at, functions::track_inverse_dynamics(workspace)), 1e-12);
    EXPECT_LE(error(ir::Quantity::inverse_dynamics_dq, at, functions::track_inverse_dynamics_dq(workspace)), 1e-12);
    const double tolerance = solved_tolerance(at);
    EXPECT_LE(error(ir::Quantity::inverse_mass_matrix, at, functions::plan_inverse_mass_matrix(workspace)), tolerance);
    EXPECT_LE(error(ir::Quantity::forward_dynamics_dq, at, functions::plan_forward_dynamics_dq(workspace)), tolerance);
    EXPECT_LE(error(ir::Quantity::forward_dynamics_dv, at, functions::plan_forward_dynamics_dv(workspace)), tolerance);
    EXPECT_TRUE(workspace.plan_status.ok());
  }
}

TEST_F(Functions, OfTheSceneComputeWhatIsOfLinks) {
  Workspace workspace;
  const Input at = input(4);
  functions::reach(at.q, at.v, workspace);
  EXPECT_LE(error(ir::Quantity::bias, at, functions::reach_bias(workspace)), 1e-12);
  const auto of_link = [&](ir::LinkQuantity quantity) {
    return reference::evaluate(model.tree, model.scene, {{std::nullopt, "c_01", quantity}}, {at.q, at.v, at.more},
                               reference::Precision::float64)
        .front();
  };
  EXPECT_TRUE(functions::reach_jacobian_mixed_c_01(workspace).isApprox(of_link(ir::LinkQuantity::jacobian_mixed), 1e-13));
  EXPECT_TRUE(functions::reach_pose_c_01(workspace).isApprox(of_link(ir::LinkQuantity::pose), 1e-13));
}

TEST_F(Functions, OfTheSceneLeaveResultsOfOthersAlone) {
  const Input at = input(3), later = input(4);
  Workspace one, other;
  functions::plan(at.q, at.v, at.more, one);
  EXPECT_TRUE(all_zero(one.inverse_mass_matrix) && all_zero(one.forward_dynamics_dq) && all_zero(one.balance_mass_matrix));
  functions::plan(at.q, at.v, at.more, other);
  functions::evaluate(later.q, later.v, other);
  functions::forward_dynamics(later.q, later.v, later.more, other);
  functions::balance(later.q, later.v, other);
  EXPECT_EQ(functions::plan_inverse_mass_matrix(other), functions::plan_inverse_mass_matrix(one));
  EXPECT_EQ(functions::plan_forward_dynamics_dq(other), functions::plan_forward_dynamics_dq(one));
}

TEST_F(Functions, OfTheSceneAreCalledFromCToo) {
  const Input at = input(5);
  functions_workspace* const c = functions_create();
  functions_balance(at.q.data(), at.v.data(), c);
  functions_plan(at.q.data(), at.v.data(), at.more.data(), c);
  Workspace workspace;
  functions::balance(at.q, at.v, workspace);
  functions::plan(at.q, at.v, at.more, workspace);
  EXPECT_EQ(std::memcmp(functions_balance_momentum_matrix(c), workspace.balance_momentum_matrix,
                        sizeof workspace.balance_momentum_matrix),
            0);
  EXPECT_EQ(std::memcmp(functions_plan_forward_dynamics_dv(c), workspace.plan_forward_dynamics_dv,
                        sizeof workspace.plan_forward_dynamics_dv),
            0);
  EXPECT_EQ(functions_plan_status(c), -1);
  functions_destroy(c);
}

TEST_F(Functions, AsTasksGiveTheSameBits) {
  Workspace serial, parallel;
  functions::TaskGraph evaluate(parallel);
  functions::InverseDynamicsTaskGraph inverse(parallel);
  functions::ForwardDynamicsTaskGraph forward(parallel);
  functions::PlanTaskGraph plan(parallel);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Input at = input(seed);
    functions::evaluate(at.q, at.v, serial);
    functions::inverse_dynamics(at.q, at.v, at.more, serial);
    functions::forward_dynamics(at.q, at.v, at.more, serial);
    evaluate.evaluate(at.q.data(), at.v.data());
    inverse.inverse_dynamics(at.q.data(), at.v.data(), at.more.data());
    forward.forward_dynamics(at.q.data(), at.v.data(), at.more.data());
    functions::plan(at.q, at.v, at.more, serial);
    plan.plan(at.q.data(), at.v.data(), at.more.data());
    const auto equal = [](const auto& a, const auto& b) { return std::memcmp(a, b, sizeof a) == 0; };
    EXPECT_TRUE(equal(serial.inverse_mass_matrix, parallel.inverse_mass_matrix));
    EXPECT_TRUE(equal(serial.inverse_dynamics, parallel.inverse_dynamics));
    EXPECT_TRUE(equal(serial.inverse_dynamics_dq, parallel.inverse_dynamics_dq));
    EXPECT_TRUE(equal(serial.regressor, parallel.regressor));
    EXPECT_TRUE(equal(serial.forward_dynamics, parallel.forward_dynamics));
    EXPECT_TRUE(equal(serial.forward_dynamics_dq, parallel.forward_dynamics_dq));
    EXPECT_TRUE(equal(serial.forward_dynamics_dv, parallel.forward_dynamics_dv));
    EXPECT_TRUE(equal(serial.plan_inverse_mass_matrix, parallel.plan_inverse_mass_matrix));
    EXPECT_TRUE(equal(serial.plan_forward_dynamics_dq, parallel.plan_forward_dynamics_dq));
  }
}

TEST_F(Functions, DoNotAllocate) {
  static Workspace workspace;
  const Input at = input(2);
  const std::uint64_t before = heap_allocations();
  functions::evaluate(at.q, at.v, workspace);
  functions::inverse_dynamics(at.q, at.v, at.more, workspace);
  functions::forward_dynamics(at.q, at.v, at.more, workspace);
  functions::plan(at.q, at.v, at.more, workspace);
  functions::track(at.q, at.v, at.more, workspace);
  EXPECT_EQ(heap_allocations() - before, 0u);
}

// Its last link has no mass but what it carries.
class SingularMass : public ::testing::Test {
 protected:
  SingularMass() { q[6] = 1, q[7] = 0.3, q[8] = -0.4; }

  void run() {
    singular::evaluate(q, v, workspace);
    singular::forward_dynamics(q, v, tau, workspace);
    singular::plan(q, v, tau, workspace);
  }
  bool nothing_is_handed_on() const {
    return all_zero(workspace.inverse_mass_matrix) && all_zero(workspace.forward_dynamics) &&
           all_zero(workspace.forward_dynamics_dq) && all_zero(workspace.forward_dynamics_dv) &&
           all_zero(workspace.plan_inverse_mass_matrix) && all_zero(workspace.plan_forward_dynamics_dq);
  }

  singular::Workspace workspace;
  double q[singular::nq] = {}, v[singular::nv] = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8},
         tau[singular::nv] = {1, 2, 3, 4, 5, 6, 7, 8};
};

TEST_F(SingularMass, IsToldAndNothingHandedOn) {
  run();
  EXPECT_EQ(workspace.status.coordinate, 7);
  EXPECT_EQ(workspace.forward_dynamics_status.coordinate, 7);
  EXPECT_EQ(workspace.plan_status.coordinate, 7);
  EXPECT_TRUE(nothing_is_handed_on());
}

TEST_F(SingularMass, IsForgottenOnceThereIsMass) {
  run();
  workspace.payload_c.mass = 1;
  workspace.payload_c.com[0] = 0.1;
  run();
  EXPECT_TRUE(workspace.status.ok() && workspace.forward_dynamics_status.ok());
  EXPECT_FALSE(nothing_is_handed_on());
  for (const double x : workspace.forward_dynamics_dq) EXPECT_TRUE(std::isfinite(x));
}

TEST_F(SingularMass, NotANumberIsNoMassEither) {
  workspace.payload_c.mass = std::nan("");
  run();
  EXPECT_FALSE(workspace.status.ok() || workspace.forward_dynamics_status.ok());
  EXPECT_TRUE(nothing_is_handed_on());
}

// There pivots are looked at where limbs leave them.
TEST_F(SingularMass, IsToldInTheRolledFormAsWell) {
  singular_rolled::Workspace rolled;
  singular_rolled::forward_dynamics(q, v, tau, rolled);
  EXPECT_EQ(rolled.forward_dynamics_status.coordinate, 7);
  EXPECT_EQ(rolled.forward_dynamics_status.pivot, 0);
  EXPECT_TRUE(all_zero(rolled.forward_dynamics));
  workspace.payload_c.mass = rolled.payload_c.mass = 1;
  workspace.payload_c.com[0] = rolled.payload_c.com[0] = 0.1;
  singular::forward_dynamics(q, v, tau, workspace);
  singular_rolled::forward_dynamics(q, v, tau, rolled);
  EXPECT_TRUE(rolled.forward_dynamics_status.ok());
  for (int i = 0; i < singular::nv; ++i)
    EXPECT_NEAR(rolled.forward_dynamics[i], workspace.forward_dynamics[i], 1e-10 * std::abs(workspace.forward_dynamics[i]));
  rolled.payload_c.mass = std::nan("");
  singular_rolled::forward_dynamics(q, v, tau, rolled);
  EXPECT_FALSE(rolled.forward_dynamics_status.ok());
  EXPECT_TRUE(std::isnan(rolled.forward_dynamics_status.pivot));
  EXPECT_TRUE(all_zero(rolled.forward_dynamics));
}

TEST_F(SingularMass, IsToldInCAsWell) {
  singular_workspace* const c = singular_create();
  singular_forward_dynamics(q, v, tau, c);
  EXPECT_EQ(singular_forward_dynamics_status(c), 7);
  EXPECT_EQ(singular_forward_dynamics_result(c)[7], 0);
  const double com[3] = {0.1, 0, 0}, inertia[6] = {};
  singular_set_payload_c(1, com, inertia, c);
  singular_forward_dynamics(q, v, tau, c);
  EXPECT_EQ(singular_forward_dynamics_status(c), -1);
  EXPECT_NE(singular_forward_dynamics_result(c)[7], 0);
  singular_destroy(c);
}

}  // namespace
}  // namespace dalembert::testing
