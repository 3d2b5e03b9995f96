// Loops that are embedded: both forms against the generic engine, which knows nothing of dalembert/linkage.hpp; against the
// same loops as rows; and what holds of any dynamics.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <string>

#include "both_forms.hpp"
#include "commands/generic_engine.hpp"
#include "compile.hpp"
#include "costs.hpp"
#include "ir/loop_length.hpp"
#include "passes/build_tree.hpp"
#include "reference/eigenvalues.hpp"
#include "reference/engine.hpp"

namespace dalembert {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ir::Quantity;

struct Mechanism {
  std::string name;                                             // of its files
  std::map<std::string, std::vector<std::string>> independent;  // per loop; none: as the scene's file says
  std::string link;                                             // asked for its frame
};
const Mechanism slider_crank{"slider_crank", {{"pin", {"crank_turn"}}}, "rod"}, ankle{"ankle", {}, "foot"},
    legs{"legs",
         {{"left_achilles", {"left_shin_joint"}},
          {"right_achilles", {"right_shin_joint"}},
          {"left_toes", {"left_crank_joint"}},
          {"right_toes", {"right_crank_joint"}}},
         "left_foot"},
    boom{"boom", {}, "rod"};

double largest(const MatrixXd& m) { return m.cwiseAbs().maxCoeff<Eigen::PropagateNaN>(); }

Model load(const Mechanism& mechanism) {
  Request request;
  request.robot = MECHANISMS "/" + mechanism.name + ".urdf";
  request.scene_file = MECHANISMS "/" + mechanism.name + ".yaml";
  Diagnostics warnings;
  Model model = read_model(request, warnings);
  for (const ir::Loop& loop : model.scene.loops) {
    model.scene.embedded.push_back(loop);
    model.scene.embedded.back().independent = mechanism.independent.at(loop.name);
  }
  model.scene.loops.clear();
  model.scene.passive.clear();
  model.scene.outputs.clear();
  model.tree = passes::build_tree(model.description, model.scene, warnings);
  return model;
}

// The same with rows.
Model with_rows(const Model& model, const std::vector<Quantity>& outputs) {
  ir::Scene scene = model.scene;
  scene.loops = scene.embedded;
  scene.embedded.clear();
  scene.outputs = outputs;
  return model_of(model.description, scene);
}

MatrixXd exact(const Model& model, Quantity quantity, const State& state) {
  return reference::evaluate(model.tree, model.scene, {{quantity, ""}}, {state.q, state.v, state.more, state.wrenches},
                             reference::Precision::extended)
      .front();
}

class Embedded : public testing::TestWithParam<Mechanism> {};
INSTANTIATE_TEST_SUITE_P(Mechanisms, Embedded, testing::Values(slider_crank, ankle, legs, boom),
                         [](const auto& p) { return p.param.name; });

TEST_P(Embedded, BothFormsAreTheGenericEngine) {
  Model model = load(GetParam());
  for (const ir::QuantityRow& row : ir::quantities())
    if (ir::is_of_linkages(row.quantity)) model.scene.outputs.push_back(row.quantity);
  for (const ir::LinkQuantityRow& row : ir::link_quantities()) model.scene.frames.push_back({row.quantity, GetParam().link});
  expect_generic_values(model);
  // With what joints add, payloads and pushes; and one function of a user's own.
  ir::Scene more = model.scene;
  for (const ir::Body& body : model.tree.bodies) {
    if (body.parts > 1) continue;
    more.armature[body.joint] = 0.02;
    more.damping[body.joint] = 0.3;
    more.friction[body.joint] = 0.1;
  }
  more.payloads = {GetParam().link};
  more.wrenches = {{GetParam().link, true}};
  more.functions = {{"step", {Quantity::bias, Quantity::mass_matrix_factor, Quantity::forward_dynamics}}};
  expect_generic_values(model_of(model.description, more), tool);
  more.functions.clear();
  more.rates_zero = true;
  more.outputs = {Quantity::mass_matrix, Quantity::bias, Quantity::inverse_dynamics, Quantity::forward_dynamics};
  expect_generic_values(model_of(model.description, more), tool);
}

TEST_P(Embedded, AccelerationsAreThoseOfRows) {
  Model model = load(GetParam());
  model.scene.outputs = {Quantity::forward_dynamics};
  const State state = some_state(model.tree);
  const Following f = following(model.tree, state);
  ASSERT_TRUE(f.status.ok());
  ASSERT_LT(f.status.error, 1e-11);
  const ir::Followers list = ir::followers(model.tree);
  State all = state;
  all.v = f.T * state.v;
  all.more = VectorXd::Zero(list.all);
  for (int i = 0; i < model.tree.nv(); ++i) all.more[list.at[static_cast<size_t>(i)]] = state.more[i];
  const Model rows = with_rows(model, {Quantity::constrained_forward_dynamics});
  EXPECT_LT(largest(exact(rows, Quantity::constraint_jacobian, all) * all.v), 1e-12 * (1 + largest(all.v)));
  const VectorXd expected = exact(rows, Quantity::constrained_forward_dynamics, all);
  const auto [straight, rolled] = run_both(model, state, {});
  for (const ir::Arrays* form : {&straight, &rolled}) {
    const VectorXd found = f.T * form->at("forward_dynamics") + f.T_rate * state.v;
    EXPECT_LT(largest(found - expected), 1e-10 * largest(expected));
  }
  const auto [straight_rows, rolled_rows] = run_both(rows, all, {});
  EXPECT_LT(largest(straight_rows.at("constrained_forward_dynamics") - expected), 1e-10 * largest(expected));
  // As rows, tau at dependent joints counts with what it does to those that are followed.
  State pushed = all;
  for (Eigen::Index i = 0; i < pushed.more.size(); ++i) pushed.more[i] += 0.3 * static_cast<double>(i % 5);
  State as_one = state;
  as_one.more = f.T.transpose() * pushed.more;
  const VectorXd of_rows = exact(rows, Quantity::constrained_forward_dynamics, pushed),
                 of_one = exact(model, Quantity::forward_dynamics, as_one);
  EXPECT_LT(largest(f.T * of_one + f.T_rate * state.v - of_rows), 1e-10 * largest(of_rows));
}

TEST_P(Embedded, KeepsWhatHoldsOfAnyDynamics) {
  const Model model = load(GetParam());
  const State state = some_state(model.tree);
  const auto value = [&](Quantity quantity, const State& at) { return exact(model, quantity, at); };
  const MatrixXd M = value(Quantity::mass_matrix, state), C = value(Quantity::coriolis_matrix, state);
  const VectorXd bias = value(Quantity::bias, state), tau = value(Quantity::inverse_dynamics, state);
  EXPECT_GT(reference::eigenvalues(M).minCoeff(), 0);
  State still = state;  // where springs are left
  still.v.setZero();
  EXPECT_LT(largest(C * state.v + value(Quantity::bias, still) - bias), 1e-11 * largest(bias));
  EXPECT_LT(largest(M * state.more + bias - tau), 1e-11 * largest(tau));
  State back = state;
  back.more = tau;
  EXPECT_LT(largest(value(Quantity::forward_dynamics, back) - state.more), 1e-10 * largest(state.more));
  EXPECT_LT(largest(M * value(Quantity::inverse_mass_matrix, state) - MatrixXd::Identity(M.rows(), M.cols())), 1e-10);
  EXPECT_NEAR(value(Quantity::kinetic_energy, state)(0, 0), state.v.dot(M * state.v) / 2, 1e-11 * largest(M));
  if (model.tree.base_coordinates() > 0) return;  // whose positions are no sums of velocities
  // M' = C + C', and what motors do is what energy there is more, by differences along the motion.
  const double h = 1e-5;
  const Following f = following(model.tree, state);
  const VectorXd rate = f.T * state.v, acceleration = f.T * state.more + f.T_rate * state.v;
  const auto moved = [&](double t) {
    State at = state;
    at.q += t * rate + t * t / 2 * acceleration;
    at.v += t * state.more;
    const LinkageStatus<double> status = ir::close_loops(model.tree, ir::closing_steps, at.q);
    EXPECT_LT(status.error, 1e-13);
    return at;
  };
  const State before = moved(-h), after = moved(h);
  const MatrixXd change = (value(Quantity::mass_matrix, after) - value(Quantity::mass_matrix, before)) / (2 * h);
  EXPECT_LT(largest(change - C - C.transpose()), 1e-7 * std::max(largest(C), largest(M)));
  const auto energy = [&](const State& at) {
    return value(Quantity::kinetic_energy, at)(0, 0) + value(Quantity::potential_energy, at)(0, 0);
  };
  const double power = (energy(after) - energy(before)) / (2 * h);
  EXPECT_NEAR(tau.dot(state.v), power, 1e-7 * (std::abs(power) + largest(tau)));
}

TEST_P(Embedded, LoopsCloseFromBesideWhereTheyAre) {
  const Model model = load(GetParam());
  const VectorXd closed = some_state(model.tree).q;
  VectorXd q = closed;
  const std::vector<int> positions = model.tree.positions();
  for (size_t k = 0; k < model.tree.bodies.size(); ++k)
    if (model.tree.bodies[k].follows)
      q[model.tree.base_positions() + positions[k]] += !model.tree.bodies[k].turns() ? 0.02 : k % 2 ? 0.05 : -0.04;
  const LinkageStatus<double> status = ir::close_loops(model.tree, ir::closing_steps, q);
  EXPECT_TRUE(status.ok());
  EXPECT_LT(status.error, 1e-14);
  EXPECT_LT(largest(q - closed), 1e-11);
}

TEST_P(Embedded, CountsWhatFollowingCosts) {
  Model model = load(GetParam());
  model.scene.outputs = {Quantity::mass_matrix, Quantity::forward_dynamics};
  const std::vector<OperationCost> own = operation_costs(model),
                                   tree = operation_costs(with_rows(model, {Quantity::mass_matrix}));
  ASSERT_EQ(own.size(), 3u);
  EXPECT_EQ(own[1].name, "mass_matrix");
  EXPECT_FALSE(own[1].reads_velocity);
  EXPECT_TRUE(own[2].reads_velocity);
  EXPECT_GT(own[1].operations.total(), tree.front().operations.total());
  EXPECT_GT(own[2].operations.total(), own[1].operations.total());
  EXPECT_GE(own.front().operations.total(), own[2].operations.total());
}

// M asks for G alone, T for how fast all joints are, C for G' besides.
TEST_P(Embedded, WhatIsNotAskedForIsNotFollowed) {
  const auto embedding = [&](Quantity quantity) {
    Model model = load(GetParam());
    model.scene.outputs = {quantity};
    return *lower_to_programs(model).functions.front().first().algorithm.embedding;
  };
  const ir::Embedding mass = embedding(Quantity::mass_matrix), energy = embedding(Quantity::kinetic_energy),
                      coriolis = embedding(Quantity::coriolis_matrix);
  EXPECT_FALSE(mass.moving);
  EXPECT_TRUE(energy.moving && coriolis.moving);
  EXPECT_LT(mass.rates, 0);
  EXPECT_LT(energy.rates, 0);
  EXPECT_GE(coriolis.rates, 0);
}

// Where crank and rod are in line the slider does not tell where they go.
// Loops are closed by sines, whether anything else of a function is or not.
TEST_P(Embedded, CodeIncludesWhatClosingCalls) {
  Model model = load(GetParam());
  model.scene.gravity_kind = ir::GravityKind::none;
  model.scene.gravity = {0, 0, 0};
  model.scene.outputs = {Quantity::gravity};
  model.name = "linked";
  bool called = false;
  for (const backend::OutputFile& file : compile_without_self_test(model)) {
    if (file.name != "dynamics.cpp") continue;
    called = file.text.find("dalembert::sincos_at<") != file.text.npos;
    EXPECT_NE(file.text.find("#include <dalembert/sincos.hpp>"), file.text.npos) << file.text.substr(0, 500);
  }
  EXPECT_TRUE(called);
}

// A rod without a length has the one of the robot where q is zero: mimic joints stand at their offsets, locked ones where they
// are locked.
TEST(LoopLength, IsThatWhereQIsZero) {
  const ir::RobotDescription chain = robot("chain_7");
  std::vector<std::string> joints;
  for (const ir::Joint& joint : chain.joints)
    if (joint.type != ir::JointType::fixed) joints.push_back(joint.name);
  const std::string first = link_moved_by(chain, joints.front()), last = link_moved_by(chain, joints.back());
  ir::Scene scene;
  scene.base = ir::Base::fixed;
  scene.loops = {
      {"rod", {first, last}, {Eigen::Isometry3d::Identity(), Eigen::Isometry3d::Identity()}, ir::LoopType::distance, {}}};
  scene.mimic[joints[3]] = {joints[1], 0.5, 0.8};
  scene.locked[joints[4]] = 0.7;
  scene.frames = {{ir::LinkQuantity::pose, first}, {ir::LinkQuantity::pose, last}};
  scene.outputs.clear();
  const Model model = model_of(chain, scene);
  State at_zero = some_state(model.tree);
  at_zero.q.setZero();
  const std::vector<Output> outputs = outputs_of(model);
  const Eigen::MatrixXd one = evaluate_generic(model, outputs[0], at_zero),
                        other = evaluate_generic(model, outputs[1], at_zero);
  EXPECT_NEAR(ir::loop_length(model.tree, model.scene.loops.front()), (one.col(3) - other.col(3)).norm(), 1e-12);
}

TEST(TogglePoint, IsSaidAndNothingIsDividedBy) {
  const Model model = load({"slider_crank", {{"pin", {"slide"}}}, ""});
  State state = some_state(model.tree);
  for (const double off : {0.0, 1e-12, 1e-10}) {
    state.q << off, 0, 0.7;
    const Following f = following(model.tree, state);
    EXPECT_EQ(f.status.linkage, 0) << off;
    EXPECT_LE(f.status.least_pivot, 1e-8);
    EXPECT_TRUE(f.T.allFinite() && f.T_rate.allFinite());
    EXPECT_EQ(largest(exact(model, Quantity::forward_dynamics, state)), 0);
    VectorXd q = state.q;
    EXPECT_EQ(ir::close_loops(model.tree, ir::closing_steps, q).linkage, 0);
    EXPECT_EQ(q, state.q);
  }
  state.q << 0.3, -0.5, 0.5;
  EXPECT_TRUE(ir::close_loops(model.tree, 40, state.q).ok());
  EXPECT_GT(largest(exact(model, Quantity::forward_dynamics, state)), 0);
}

}  // namespace
}  // namespace dalembert
