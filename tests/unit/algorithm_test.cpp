// Both forms of the algorithms interpreted in double, against the generic engine: on every robot, and where numbers are
// awkward. No code is compiled.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <robots.hpp>

#include "commands/generic_engine.hpp"
#include "commands/output.hpp"
#include "frontend/urdf_reader.hpp"
#include "interpret.hpp"
#include "passes/build_tree.hpp"
#include "passes/combine_inertia.hpp"
#include "passes/normalise.hpp"
#include "passes/plan.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/roll.hpp"
#include "passes/unroll.hpp"
#include "reference/engine.hpp"

namespace dalembert {
namespace {

using Payload = std::array<double, 10>;  // mass, centre of mass, inertia xx xy xz yy yz zz

ir::RobotDescription robot(std::string_view name) {
  Diagnostics warnings;
  for (const TestRobot& r : test_robots)
    if (r.name == name) return frontend::read_urdf(r.urdf, warnings);
  throw std::invalid_argument(std::string(name));
}

Model model_of(const ir::RobotDescription& description, const ir::Scene& scene) {
  Diagnostics warnings;
  Model model;
  model.description = description;
  model.scene = scene;
  model.tree = passes::build_tree(description, scene, warnings);
  return model;
}

State some_state(const ir::KinematicTree& tree) {
  State state{"", Eigen::VectorXd(tree.nq()), Eigen::VectorXd(tree.nv()), Eigen::VectorXd(tree.nv()),
              Eigen::VectorXd(6 * static_cast<Eigen::Index>(tree.pushed.size()))};
  for (Eigen::Index i = 0; i < state.wrenches.size(); ++i) state.wrenches[i] = 3 * std::cos(0.4 + 2.3 * static_cast<double>(i));
  for (int i = 0; i < tree.nq(); ++i) state.q[i] = std::sin(1.0 + 1.7 * i);
  for (int i = 0; i < tree.nv(); ++i) state.v[i] = std::cos(2.0 + 1.3 * i);
  for (int i = 0; i < tree.nv(); ++i) state.more[i] = std::cos(1.0 + 1.9 * i);
  if (tree.floating_base) state.q.segment<4>(3).normalize();
  return state;
}

std::string link_moved_by(const ir::RobotDescription& robot, const std::string& name) {
  for (const ir::Joint& joint : robot.joints)
    if (joint.name == name) return robot.links[static_cast<size_t>(joint.child)].name;
  throw std::invalid_argument(name);
}

// The payload welded to the link.
ir::KinematicTree welded(ir::KinematicTree tree, const std::string& link, const Payload& p) {
  ir::Inertia inertia{p[0], {p[1], p[2], p[3]}, {}};
  inertia.inertia << p[4], p[5], p[6], p[5], p[7], p[8], p[6], p[8], p[9];
  for (const ir::LinkPlacement& at : tree.links) {
    if (at.link != link) continue;
    inertia.com = at.placement * inertia.com;
    inertia.inertia = at.placement.linear() * inertia.inertia * at.placement.linear().transpose();
    ir::Inertia& body = at.body < 0 ? tree.base : tree.bodies[static_cast<size_t>(at.body)].inertia;
    body = passes::combined({body, inertia});
  }
  return tree;
}

// The results of one function, or of one half of it behind what the other left, in both forms.
std::array<ir::Arrays, 2> run_half(const ir::EmittedFunction& function, const Model& model, const State& state,
                                   const Payload& payload, const std::array<ir::Arrays, 2>& left = {}) {
  const ir::NormalTree normal = passes::normalise(model.tree, passes::normalise_options(model.scene, true));
  const ir::Algorithm algorithm = passes::describe(function, model.tree, normal, model.scene, {});
  passes::Unroll unroll(algorithm, model.tree, normal, model.scene, {{}, false});
  const ir::FunctionInput input = [&](const ir::Input& in) {
    switch (in.kind) {
      case ir::InputKind::position: return state.q[in.index];
      case ir::InputKind::velocity: return state.v[in.index];
      case ir::InputKind::acceleration:
      case ir::InputKind::effort: return state.more[in.index];
      case ir::InputKind::gravity: return model.scene.gravity[in.component];
      case ir::InputKind::wrench: return state.wrenches[6 * in.index + in.component];
      case ir::InputKind::payload: return payload[static_cast<size_t>(in.component)];
      default: return std::nan("");
    }
  };
  ir::Arrays straight = ir::run(algorithm, unroll.program(), input, left[0]);
  ir::CompileOptions options;
  options.form = ir::Form::rolled;
  const ir::Plan plan = passes::plan(model.tree, model.scene, {}, options);
  if (plan.form != ir::Form::rolled) return {straight, straight};  // a base alone
  const ir::RolledProgram program = passes::roll(algorithm, unroll, model.tree, model.scene, plan, {});
  ir::RolledRun run(algorithm, program, plan, model.tree, model.scene.rates_zero, input);
  run.run(left[1]);
  return {straight, run.run(left[1])};  // the second evaluation: nothing may be left of the first
}

// A second half takes what the first finds in its form.
std::array<ir::Arrays, 2> run_function(const ir::EmittedFunction& function, const Model& model, const State& state,
                                       const Payload& payload) {
  const std::vector<ir::EmittedFunction> halves = passes::halves(function, model.tree);
  std::array<ir::Arrays, 2> results = run_half(halves.front(), model, state, payload);
  if (halves.size() == 1) return results;
  for (size_t form : {0u, 1u}) {
    State solved = state;
    solved.more = results[form].at(halves.front().accelerations);
    results[form] = run_half(halves.back(), model, solved, payload, results)[form];
  }
  return results;
}

std::array<ir::Arrays, 2> run_both(const Model& model, const State& state, const Payload& payload) {
  std::array<ir::Arrays, 2> results;
  for (const ir::EmittedFunction& function : ir::functions_of(model.scene)) {
    std::array<ir::Arrays, 2> own = run_function(function, model, state, payload);
    for (size_t form : {0u, 1u}) results[form].merge(own[form]);
  }
  return results;
}

// Every output of the scene, in both forms, with `payload` at each link that carries one.
void expect_generic_values(const Model& model, const Payload& payload = {}) {
  Model expected = model;
  for (const std::string& link : model.scene.payloads) expected.tree = welded(expected.tree, link, payload);
  const State state = some_state(model.tree);
  const auto [straight, rolled] = run_both(model, state, payload);
  for (const Output& output : outputs_of(model)) {
    SCOPED_TRACE(output.name);
    const Eigen::MatrixXd reference = evaluate_generic(expected, output, state);
    // Where a robot makes a quantity vanish, rounding of larger terms is left.
    double tolerance = 1e-12 * std::max(reference.cwiseAbs().maxCoeff(), 1e-3);
    if (output.quantity && ir::row_of(*output.quantity).scale == ir::Scale::solved)
      tolerance = std::max(tolerance, 10 * reference.cwiseAbs().maxCoeff() * 0x1p-53 *
                                          reference::mass_condition(expected.tree, expected.scene,
                                                                    {state.q, state.v, state.more, state.wrenches}));
    EXPECT_LE((straight.at(output.name) - reference).cwiseAbs().maxCoeff<Eigen::PropagateNaN>(), tolerance) << "straight";
    EXPECT_LE((rolled.at(output.name) - reference).cwiseAbs().maxCoeff<Eigen::PropagateNaN>(), tolerance) << "rolled";
  }
}

class Algorithm : public testing::TestWithParam<TestRobot> {};

// Everything the compiler knows, on every topology: each quantity alone, all together, statics, gravity at run time, Jacobians,
// payloads, driven joints, armature, damping, friction and springs.
TEST_P(Algorithm, RunsInBothFormsAsTheGenericEngineDoes) {
  const ir::RobotDescription description = robot(GetParam().name);
  std::vector<std::string> moving;
  for (const ir::Joint& joint : description.joints)
    if (joint.type != ir::JointType::fixed) moving.push_back(joint.name);
  for (const ir::Base base : {ir::Base::fixed, ir::Base::floating}) {
    std::map<std::string, ir::Scene> scenes;
    ir::Scene all;
    all.base = base;
    all.gravity = {0.7, -1.3, -9.81};
    for (const ir::QuantityRow& row : ir::quantities()) {
      ir::Scene alone = all;
      alone.outputs = {row.quantity};
      scenes[row.name] = alone;
    }
    all.outputs.clear();
    for (const ir::QuantityRow& row : ir::quantities()) all.outputs.push_back(row.quantity);
    scenes["all"] = all;
    // Whatever one function can compute, whatever of it stands first.
    ir::Scene named = all;
    named.outputs.clear();
    for (const auto& [name, other] :
         {std::pair{"drive", ir::Function::forward_dynamics}, {"fly", ir::Function::inverse_dynamics}}) {
      named.functions.push_back({name, {}});
      for (const ir::Quantity quantity : all.outputs)
        if (ir::row_of(quantity).function != other)
          named.functions.back().quantities.insert(named.functions.back().quantities.begin(), quantity);
    }
    scenes["functions of the scene"] = named;
    ir::Scene statics = all;
    statics.rates_zero = true;
    std::erase(statics.outputs, ir::Quantity::coriolis_matrix);
    scenes["statics"] = statics;
    ir::Scene run_time = all;
    run_time.gravity_kind = ir::GravityKind::run_time;
    scenes["gravity at run time"] = run_time;
    ir::Scene friction = all;
    for (size_t j = 0; j < moving.size(); j += 2)
      friction.armature[moving[j]] = 0.3, friction.damping[moving[j]] = 0.7, friction.friction[moving[j]] = 1.1;
    scenes["armature, damping, friction"] = friction;
    ir::Scene springs = all;
    for (size_t j = 0; j < moving.size(); j += 2) springs.stiffness[moving[j]] = {3.0 + static_cast<double>(j), 0.4};
    scenes["springs"] = springs;
    ir::Scene elastic = springs;
    for (size_t j = 0; j < moving.size(); j += 3) elastic.elastic[moving[j]] = {200, 0.5, 0.3};
    scenes["elastic joints"] = elastic;
    ir::Scene resting = springs;
    resting.rates_zero = true;
    std::erase(resting.outputs, ir::Quantity::coriolis_matrix);
    scenes["springs in statics"] = resting;
    springs.gravity_kind = ir::GravityKind::none;
    springs.gravity.setZero();
    scenes["springs without gravity"] = springs;
    ir::Scene christoffel = all;
    christoffel.coriolis = ir::Coriolis::christoffel;
    scenes["Christoffel's C"] = christoffel;
    ir::Scene factored = all;
    factored.forward_dynamics = ir::Solver::factorization;
    std::erase(factored.outputs, ir::Quantity::mass_matrix_factor);
    scenes["solved by factors"] = factored;
    if (moving.size() > 2) {
      ir::Scene driven = all;
      driven.mimic[moving[1]] = {moving[0], -0.5, 0.2};
      driven.mimic[moving.back()] = {moving[0], 1.5, 0};
      driven.stiffness[moving[0]] = {7, -0.3};
      driven.wrenches = {{link_moved_by(description, moving.back()), true}};
      driven.elastic = {{moving[1], {300, 0.2, 0.1}}, {moving[0], {200, 0, 0.4}}};
      scenes["driven joints"] = driven;
      for (const ir::Quantity quantity : {ir::Quantity::forward_dynamics_dq, ir::Quantity::forward_dynamics_dv}) {
        ir::Scene alone = driven;
        alone.outputs = {quantity};
        scenes[fmt::format("{}, driven joints", ir::row_of(quantity).name)] = alone;
      }
    }
    try {
      for (const auto& [name, scene] : scenes) {
        SCOPED_TRACE((base == ir::Base::fixed ? "fixed base, " : "floating base, ") + name);
        Model model = model_of(description, scene);
        expect_generic_values(model);
        if (name != "all") continue;
        for (size_t l = 1; l < model.tree.links.size(); l += 3)
          if (model.tree.links[l].body >= 0 || base == ir::Base::floating)
            model.scene.jacobians.push_back(model.tree.links[l].link);
        for (size_t l = 2; l < model.tree.links.size(); l += 7)
          if (model.tree.links[l].body >= 0 || base == ir::Base::floating)
            for (const ir::LinkQuantityRow& row : ir::link_quantities())
              model.scene.frames.push_back({row.quantity, model.tree.links[l].link});
        expect_generic_values(model);
        Model functions = model;
        functions.scene.functions = {{"move",
                                      {ir::Quantity::mass_matrix, ir::Quantity::bias, ir::Quantity::inverse_dynamics},
                                      model.scene.link_outputs()},
                                     {"look", {}, model.scene.link_outputs()}};
        functions.scene.outputs = {ir::Quantity::gravity};
        expect_generic_values(functions);
        ir::Scene pushed = scene;
        for (size_t l = 1; l < model.tree.links.size(); l += 4)
          if (model.tree.links[l].body >= 0 || base == ir::Base::floating)
            pushed.wrenches.push_back({model.tree.links[l].link, l % 8 == 1});
        expect_generic_values(model_of(description, pushed));
        pushed.rates_zero = true;
        std::erase(pushed.outputs, ir::Quantity::coriolis_matrix);
        expect_generic_values(model_of(description, pushed));
        for (size_t l = 2; l < model.tree.links.size(); l += 5) {
          const int body = model.tree.links[l].body;
          const auto same = [&](const std::string& link) {
            return std::any_of(model.tree.links.begin(), model.tree.links.end(),
                               [&](const ir::LinkPlacement& p) { return p.link == link && p.body == body; });
          };
          if (std::none_of(model.scene.payloads.begin(), model.scene.payloads.end(), same) && body >= 0)
            model.scene.payloads.push_back(model.tree.links[l].link);
        }
        expect_generic_values(model, {1.7, 0.03, -0.02, 0.11, 0.02, 0.003, -0.001, 0.03, 0.002, 0.025});
      }
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("mass"), std::string::npos) << error.what();  // a floating base without inertia
    }
  }
}

// What other joints do is not read, even where loops run over limbs side by side: not a number there makes none here.
TEST_P(Algorithm, ReadsForALinkTheJointsAboveItAlone) {
  const ir::RobotDescription description = robot(GetParam().name);
  for (const ir::Base base : {ir::Base::fixed, ir::Base::floating}) {
    ir::Scene scene;
    scene.base = base;
    scene.outputs.clear();
    const Model whole = model_of(description, scene);
    const std::vector<ir::LinkPlacement>& links = whole.tree.links;
    for (size_t l = 0; l < links.size(); l += 1 + links.size() / 6) {
      const ir::LinkPlacement& at = links[l];
      if (at.body < 0 && base == ir::Base::fixed) continue;
      SCOPED_TRACE(at.link);
      Model model = whole;
      for (const ir::LinkQuantityRow& row : ir::link_quantities()) model.scene.frames.push_back({row.quantity, at.link});
      State state = some_state(model.tree);
      const Eigen::Index joints = model.tree.joints();
      for (Eigen::Index k = 0; k < joints; ++k)
        if (!model.tree.is_above(static_cast<int>(k), at.body))
          state.q[state.q.size() - joints + k] = state.v[state.v.size() - joints + k] = std::nan("");
      const auto [straight, rolled] = run_both(model, state, {});
      for (const Output& output : outputs_of(model)) {
        EXPECT_TRUE(straight.at(output.name).allFinite()) << "straight: " << output.name;
        EXPECT_TRUE(rolled.at(output.name).allFinite()) << "rolled: " << output.name;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, Algorithm, testing::ValuesIn(test_robots),
                         [](const auto& info) { return std::string(info.param.name); });

constexpr Payload tool{1.7, 0.03, -0.02, 0.11, 0.02, 0.003, -0.001, 0.03, 0.002, 0.025};

// Its largest component rounds to 1, and yet it is no coordinate axis.
TEST(AlgorithmAt, AnAxisAlmostAlongACoordinateAxisKeepsItsDirection) {
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(1, 1e-9, -2e-9), Eigen::Vector3d(1e-8, -1, 0)}) {
    ir::RobotDescription chain = robot("chain_7");
    for (ir::Joint& joint : chain.joints) joint.axis = axis.normalized();
    expect_generic_values(model_of(chain, {}));
  }
}

TEST(AlgorithmAt, APayloadAtTheFloatingBaseEqualsTheSameWeldedOn) {
  ir::Scene scene;
  scene.payloads = {"base"};
  expect_generic_values(model_of(robot("branch_below_base"), scene), tool);
}

// What generated and generic derivatives with a wrench along the world's axes have in common might be wrong in both.
TEST(AlgorithmAt, DerivativesWithWrenchesAreDifferences) {
  ir::Scene scene;
  scene.base = ir::Base::fixed;
  scene.outputs = {ir::Quantity::inverse_dynamics, ir::Quantity::inverse_dynamics_dq};
  for (const bool in_world : {false, true}) {
    scene.wrenches = {{"link_04", in_world}, {"link_07", !in_world}};
    const Model model = model_of(robot("chain_7"), scene);
    State state = some_state(model.tree);
    const auto results = [&] { return run_function(ir::functions_of(model.scene).front(), model, state, {})[0]; };
    const Eigen::MatrixXd derivative = results().at("inverse_dynamics_dq");
    constexpr double h = 1e-5;
    for (Eigen::Index i = 0; i < state.q.size(); ++i) {
      state.q[i] += h;
      const Eigen::MatrixXd above = results().at("inverse_dynamics");
      state.q[i] -= 2 * h;
      const Eigen::MatrixXd below = results().at("inverse_dynamics");
      state.q[i] += h;
      EXPECT_LE(((above - below) / (2 * h) - derivative.col(i)).cwiseAbs().maxCoeff(), 1e-8 * derivative.cwiseAbs().maxCoeff());
    }
  }
}

TEST(AlgorithmAt, APayloadOnALinkWithoutMassMayBeEmpty) {
  ir::RobotDescription chain = robot("chain_7");
  chain.links.back().inertia.reset();
  ir::Scene scene;
  scene.payloads = {chain.links.back().name};
  expect_generic_values(model_of(chain, scene));
  expect_generic_values(model_of(chain, scene), tool);
}

TEST(AlgorithmAt, APayloadMayBeAllThatIsLeft) {
  const ir::RobotDescription pendulum = robot("pendulum");
  ir::Scene scene;
  scene.payloads = {"base"};
  scene.cut = {pendulum.links.back().name};
  const Model model = model_of(pendulum, scene);
  expect_generic_values(model, tool);
}

}  // namespace
}  // namespace dalembert
