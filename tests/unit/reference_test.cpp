// Frames of reference up a branch: whichever body's it is, M and what is made of it are the same; where a choice saves
// operations it is made, and where the base moves there is none.
#include "passes/reference.hpp"

#include <gtest/gtest.h>

#include "both_forms.hpp"
#include "commands/generic_engine.hpp"
#include "lower.hpp"
#include "passes/normalise.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/unroll.hpp"

namespace dalembert {
namespace {

using ir::Quantity;

ir::Scene fixed_scene() {
  ir::Scene scene;
  scene.base = ir::Base::fixed;
  scene.outputs = {Quantity::mass_matrix, Quantity::coriolis_matrix, Quantity::inverse_mass_matrix};
  return scene;
}

// By every body's frame, one at a time, against the generic engine.
void expect_same_by_every_body(const Model& model) {
  const State state = some_state(model.tree);
  const ir::NormalTree normal = passes::normalise(model.tree, passes::normalise_options(model.scene, true));
  const ir::EmittedFunction function = ir::functions_of(model.scene).front();
  Model loaded = model;
  for (const std::string& link : model.scene.payloads) loaded.tree = welded(loaded.tree, link, tool);
  const ir::Algorithm algorithm =
      passes::describe(function, model.tree, normal, model.scene, ir::Solver::articulated_bodies, {}, {false, true}).front();
  for (int body = 0; body < model.tree.joints(); ++body) {
    SCOPED_TRACE(model.tree.bodies[static_cast<size_t>(body)].joint);
    passes::Unroll unroll(algorithm, model.tree, normal, model.scene, {{}, false, false, ir::Elements::kept, {body}});
    const ir::Arrays arrays = ir::run(algorithm, unroll.program(), model.tree, [&](const ir::Input& in) {
      if (in.kind == ir::InputKind::payload) return tool[static_cast<size_t>(in.component)];
      return in.kind == ir::InputKind::position ? state.q[in.index] : state.v[in.index];
    });
    for (const Output& output : outputs_of(model)) {
      if (!arrays.contains(output.name)) continue;
      const Eigen::MatrixXd expected = evaluate_generic(loaded, output, state);
      EXPECT_LE((arrays.at(output.name) - expected).cwiseAbs().maxCoeff<Eigen::PropagateNaN>(),
                1e-10 * expected.cwiseAbs().maxCoeff())
          << output.name;
    }
  }
}

TEST(Reference, IsTheFrameOfAnyBody) {
  for (const char* name : {"chain_7", "gantry", "grippers", "two_levels_of_branching", "prismatic_mix"}) {
    SCOPED_TRACE(name);
    ir::Scene scene = fixed_scene();
    expect_same_by_every_body(model_of(robot(name), scene));
    for (const ir::Coriolis coriolis : {ir::Coriolis::balance, ir::Coriolis::christoffel}) {
      scene.coriolis = coriolis;
      expect_same_by_every_body(model_of(robot(name), scene));
    }
  }
}

// Whatever the first joint is: what its body alone makes of M is left to the joint, or is not.
TEST(Reference, IsTheFrameOfAnyBodyBehindAnyFirstJoint) {
  const ir::RobotDescription arm = robot("chain_7");
  const ir::Joint& first = arm.joints[static_cast<size_t>(arm.children[static_cast<size_t>(arm.root)].front())];
  for (const ir::JointType type : {ir::JointType::prismatic, ir::JointType::spherical, ir::JointType::helical,
                                   ir::JointType::planar, ir::JointType::universal, ir::JointType::floating}) {
    SCOPED_TRACE(static_cast<int>(type));
    ir::Scene scene = fixed_scene();
    scene.joints[first.name] = {type, 0.3, {0, 1, 0}};
    expect_same_by_every_body(model_of(arm, scene));
    scene.armature[first.name] = 0.7;
    scene.payloads = {arm.links[static_cast<size_t>(first.child)].name};
    expect_same_by_every_body(model_of(arm, scene));
  }
}

TEST(Reference, IsTheFrameOfAnyBodyWhereJointsFollowOthers) {
  const ir::RobotDescription arms = robot("two_levels_of_branching");
  ir::Scene scene = fixed_scene();
  scene.outputs = {Quantity::mass_matrix, Quantity::coriolis_matrix};
  scene.mimic[arms.joints.front().name] = {arms.joints[2].name, -1.7, 0.2};
  expect_same_by_every_body(model_of(arms, scene));
}

long operations(Model model, bool refer) {
  model.options.form = ir::Form::straight;
  model.options.refer = refer;
  return ir::operations(lower(model).functions.front().first().program).total();
}

TEST(Reference, IsChosenWhereItSavesOperations) {
  ir::Scene scene;
  scene.base = ir::Base::fixed;
  scene.outputs = {Quantity::mass_matrix};
  for (const char* name : {"chain_7", "skew_chain_10", "double_pendulum", "branch_below_base"}) {
    const Model model = model_of(robot(name), scene);
    EXPECT_LT(operations(model, true), 0.96 * static_cast<double>(operations(model, false))) << name;
  }
  scene.base = ir::Base::floating;
  const Model model = model_of(robot("chain_7"), scene);
  EXPECT_EQ(operations(model, true), operations(model, false));
}

// The furthest up that may be chosen, of M.
std::vector<int> furthest(const ir::RobotDescription& arm, const ir::Scene& scene) {
  const Model model = model_of(arm, scene);
  const ir::NormalTree normal = passes::normalise(model.tree, passes::normalise_options(model.scene, true));
  const ir::Algorithm algorithm = passes::describe(ir::functions_of(model.scene).front(), model.tree, normal, model.scene,
                                                   ir::Solver::articulated_bodies, {}, {false, true})
                                      .front();
  const auto cost = [](const std::vector<int>& bodies) { return -bodies.front(); };
  return passes::reference_bodies(algorithm, model.tree, normal, cost);
}

void make_light(ir::RobotDescription& arm, size_t link, double factor) {
  arm.links[link].inertia->mass *= factor;
  arm.links[link].inertia->inertia *= factor;
}

// The third of four bodies, 100 m along a light link, from the first two, which are heavy.
TEST(Reference, IsNotFarFromWhatIsHeavy) {
  ir::RobotDescription arm = robot("chain_7");
  ir::Scene scene;
  scene.base = ir::Base::fixed;
  scene.outputs = {Quantity::mass_matrix};
  const auto chosen = [&] { return furthest(arm, scene); };
  EXPECT_EQ(chosen(), std::vector<int>{4});
  arm.joints[3].origin.translation().x() += 100;
  for (const size_t light : {4u, 5u, 6u, 7u}) make_light(arm, light, 1e-9);
  EXPECT_EQ(chosen(), std::vector<int>{2});
  scene.joints[arm.joints[2].name] = {ir::JointType::prismatic, 0, {0, 1, 0}};
  EXPECT_EQ(chosen(), std::vector<int>{1});
}

// A link beside a heavy boom 10 m away. Where it is light, its row of M would be rounded by ten metres squared.
TEST(Reference, IsNotFarFromWhatIsLight) {
  ir::RobotDescription crane = robot("chain_7");
  crane.joints[2].parent = crane.joints[1].parent;
  crane.children[1] = {1, 2}, crane.children[2].clear();
  crane.joints[2].origin.translation().x() += 10;
  crane.links[2].inertia->inertia *= 1e5;
  ir::Scene scene;
  scene.base = ir::Base::fixed;
  scene.outputs = {Quantity::mass_matrix};
  EXPECT_GT(furthest(crane, scene).front(), 1);
  make_light(crane, 2, 1e-3);
  EXPECT_GT(furthest(crane, scene).front(), 1);
  crane.links[2].inertia->inertia *= 1e-5;
  EXPECT_LE(furthest(crane, scene).front(), 1);  // the light link itself is as far from the boom as the first
}

}  // namespace
}  // namespace dalembert
