// The algorithms in both forms on every robot, and where numbers are awkward.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <dalembert/integrators/motion.hpp>

#include "both_forms.hpp"
#include "commands/generic_engine.hpp"
#include "frontend/urdf_reader.hpp"
#include "long_tests.hpp"
#include "reference/engine.hpp"

namespace dalembert {
namespace {

class Algorithm : public testing::TestWithParam<TestRobot> {};

// Everything the compiler knows, on every topology: each quantity alone (on large robots where DALEMBERT_LARGE_ROBOTS is set,
// as tests/long.sh has it: they take most of the time), all together, statics, gravity at run time, Jacobians, payloads, driven
// joints, armature, damping, friction and springs.
TEST_P(Algorithm, RunsInBothFormsAsTheGenericEngineDoes) {
  const ir::RobotDescription description = robot(GetParam().name);
  std::vector<std::string> moving;
  for (const ir::Joint& joint : description.joints)
    if (joint.type != ir::JointType::fixed) moving.push_back(joint.name);
  const bool even = description.joints.size() % 2 == 0;
  for (const ir::Base base : {ir::Base::fixed, ir::Base::floating}) {
    if (!long_tests() && even != (base == ir::Base::fixed)) continue;  // one for each robot
    std::map<std::string, ir::Scene> scenes;
    ir::Scene all;
    all.base = base;
    all.gravity = {0.7, -1.3, -9.81};
    all.contacts = some_contacts(description);
    all.loops = some_loops(description);
    const size_t of_robot =
        static_cast<size_t>(std::find_if(std::begin(test_robots), std::end(test_robots),
                                         [](const TestRobot& r) { return std::string(r.name) == GetParam().name; }) -
                            std::begin(test_robots));
    const bool large = description.joints.size() > 16;
    size_t number = of_robot;
    for (const ir::QuantityRow& row : ir::quantities()) {
      if (description.joints.size() > 48 && !std::getenv("DALEMBERT_LARGE_ROBOTS")) continue;
      if (!long_tests() && ++number % 3 != 0) continue;  // each quantity of a third of the robots; see below
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
    named.gravity_kind = ir::GravityKind::none;
    named.gravity.setZero();
    scenes["functions of the scene without gravity"] = named;
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
    if (!long_tests())  // each scene of a third of the robots, of a sixth of the larger ones
      std::erase_if(scenes, [&](const auto& scene) {
        return scene.first != "all" && scene.first != "driven joints" && ++number % (large ? 6 : 3) != 0;
      });
    if (description.joints.size() > 48 && !long_tests())
      std::erase_if(scenes, [](const auto& scene) { return scene.first != "all" && scene.first != "driven joints"; });
    for (const auto& [name, scene] : scenes) {
      SCOPED_TRACE((base == ir::Base::fixed ? "fixed base, " : "floating base, ") + name);
      Model model = model_of(description, scene);
      expect_generic_values(model);
      if (name != "all" || (!long_tests() && of_robot % 3 != 0)) continue;
      for (size_t l = 1; l < model.tree.links.size(); l += 3)
        if (model.tree.links[l].body >= 0 || base == ir::Base::floating)
          model.scene.jacobians.push_back(model.tree.links[l].link);
      for (size_t l = 2; l < model.tree.links.size(); l += 7)
        if (model.tree.links[l].body >= 0 || base == ir::Base::floating)
          for (const ir::LinkQuantityRow& row : ir::link_quantities())
            model.scene.frames.push_back({row.quantity, model.tree.links[l].link});
      expect_generic_values(model);
      Model functions = model;
      functions.scene.functions = {
          {"move", {ir::Quantity::mass_matrix, ir::Quantity::bias, ir::Quantity::inverse_dynamics}, model.scene.link_outputs()},
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

// A joint's follower turns back what it turns, about the same axis: what is left of M is a difference, whose rounding its own
// size does not tell. What is ok has a right digit, and what has lost five is ok still.
TEST(AlgorithmAt, WhatFollowersCancelIsNotTakenForInertia) {
  ir::RobotDescription gear = robot("double_pendulum");
  for (ir::Joint& joint : gear.joints) joint.origin = Eigen::Isometry3d::Identity(), joint.axis = Eigen::Vector3d::UnitZ();
  ir::Scene scene;
  scene.base = ir::Base::fixed;
  scene.outputs = {ir::Quantity::forward_dynamics};
  int ok = 0;
  for (int digits = 1; digits <= 20; ++digits)
    for (const double off : {0.0, 0.5}) {
      const double own = std::pow(10.0, -digits), multiplier = -1 + off * std::sqrt(own);
      const double rest = 1 + multiplier, exact = own + rest * rest;
      for (const double inertia : {own, 1.0})
        gear.links[inertia == own ? 1 : 2].inertia =
            ir::Inertia{1, Eigen::Vector3d::Zero(), inertia * Eigen::Matrix3d::Identity()};
      scene.mimic["link_02_joint"] = {"link_01_joint", multiplier, 0};
      const Model model = model_of(gear, scene);
      State state = some_state(model.tree);
      state.v.setZero();
      state.more.setConstant(exact);
      for (const ir::Arrays& form : run_both(model, state, {})) {
        const double acceleration = form.at("forward_dynamics")(0, 0);
        EXPECT_TRUE(acceleration == 0 ? digits > 10 : std::abs(acceleration - 1) < 0.1) << own << ": " << acceleration;
        ok += acceleration != 0;
      }
    }
  EXPECT_LT(ok, 4 * 14);
  // What pivots are measured by: the base's as M has it.
  scene.base = ir::Base::floating;
  scene.outputs.push_back(ir::Quantity::mass_matrix);
  gear.links[1].inertia->inertia = 0.5 * Eigen::Matrix3d::Identity();
  gear.links[2].inertia->inertia = 0.7 * Eigen::Matrix3d::Identity();
  scene.mimic["link_02_joint"].multiplier = -0.9;
  const Model floating = model_of(gear, scene);
  for (const ir::Arrays& form : run_both(floating, some_state(floating.tree), {})) {
    Eigen::VectorXd expected = form.at("mass_matrix").diagonal();
    expected[6] = 0.5 + 0.7 + 0.9 * 0.9 * 0.7;
    EXPECT_TRUE(form.at("forward_dynamics_diagonal_apart").isApprox(expected, 1e-14));
  }
}

// A frame of the scene's own against its link's results, computed in fifty digits and moved by hand.
TEST(AlgorithmAt, AFrameOfTheScenesOwnIsItsLinkMovedByHand) {
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  using Matrix3 = Eigen::Matrix<long double, 3, 3>;
  using Vector3 = Eigen::Matrix<long double, 3, 1>;
  using Turn = Eigen::AngleAxis<long double>;
  const ir::RobotDescription description = robot("two_levels_of_branching");
  for (const ir::Base base : {ir::Base::fixed, ir::Base::floating}) {
    ir::Scene scene;
    scene.base = base;
    scene.outputs.clear();
    const std::string link = description.links.back().name;
    scene.placed = {{"sole", link, {0.1, -0.2, 0.3}, {0.4, -0.5, 2.6}}, {"heel", link, {-0.3, 0, 0.05}, {}}};
    for (const ir::LinkQuantityRow& row : ir::link_quantities())
      for (const std::string& name : {link, std::string("sole"), std::string("heel")})
        scene.frames.push_back({row.quantity, name});
    const Model model = model_of(description, scene);
    expect_generic_values(model);
    const State state = some_state(model.tree);
    std::map<ir::LinkQuantity, Matrix> of_link;
    const auto exactly = [&](const std::string& name, ir::LinkQuantity quantity) {
      return reference::evaluate(model.tree, scene, {{std::nullopt, name, quantity}}, {state.q, state.v},
                                 reference::Precision::digits_50)
          .front();
    };
    for (const ir::LinkQuantityRow& row : ir::link_quantities())
      of_link[row.quantity] = exactly(link, row.quantity).cast<long double>();
    for (const ir::Frame& frame : scene.placed) {
      SCOPED_TRACE(frame.name);
      const Matrix3 turn = (Turn(frame.rpy.z(), Vector3::UnitZ()) * Turn(frame.rpy.y(), Vector3::UnitY()) *
                            Turn(frame.rpy.x(), Vector3::UnitX()))
                               .toRotationMatrix();
      const Vector3 x = frame.xyz.cast<long double>();
      const Matrix& pose = of_link.at(ir::LinkQuantity::pose);
      const Matrix3 R = pose.leftCols(3);
      // Six rows at the link's origin, or columns of them, to the frame's: the same axes, then turned.
      const auto moved = [](const Matrix& rows, const Vector3& lever) {
        Matrix result = rows;
        for (Eigen::Index c = 0; c < rows.cols(); ++c) result.block<3, 1>(0, c) += Vector3(rows.block<3, 1>(3, c)).cross(lever);
        return result;
      };
      const auto turned = [&](Matrix rows) {
        rows.topRows(3) = (turn.transpose() * rows.topRows(3)).eval();
        rows.bottomRows(3) = (turn.transpose() * rows.bottomRows(3)).eval();
        return rows;
      };
      const auto expect = [&](ir::LinkQuantity quantity, const Matrix& expected) {
        const Matrix ours = exactly(frame.name, quantity).cast<long double>();
        EXPECT_LE((ours - expected).cwiseAbs().maxCoeff(), 1e-15L * std::max(expected.cwiseAbs().maxCoeff(), 1.0L))
            << ir::row_of(quantity).name;
      };
      Matrix placed(3, 4);
      placed << R * turn, R * x + pose.col(3);
      expect(ir::LinkQuantity::pose, placed);
      for (const auto quantity : {ir::LinkQuantity::twist, ir::LinkQuantity::jacobian, ir::LinkQuantity::acceleration_bias})
        expect(quantity, turned(moved(of_link.at(quantity), x)));
      for (const auto quantity : {ir::LinkQuantity::jacobian_world, ir::LinkQuantity::acceleration_bias_world})
        expect(quantity, of_link.at(quantity));
      expect(ir::LinkQuantity::jacobian_mixed, moved(of_link.at(ir::LinkQuantity::jacobian_mixed), R * x));
      const Vector3 w = R * of_link.at(ir::LinkQuantity::twist).bottomRows(3);
      Matrix bias = moved(of_link.at(ir::LinkQuantity::acceleration_bias_mixed), R * x);
      bias.topRows(3) += w.cross(w.cross(R * x));
      expect(ir::LinkQuantity::acceleration_bias_mixed, bias);
    }
  }
}

// What is done to a frame of the scene's own is the same done to its link elsewhere.
TEST(AlgorithmAt, AFrameOfTheScenesOwnIsPushedLoadedAndHeldAsItsLinkIs) {
  const ir::RobotDescription description = robot("two_levels_of_branching");
  const std::string link = description.links.back().name;
  const ir::Frame sole{"sole", link, {0.1, -0.2, 0.3}, {0.4, -0.5, 2.6}};
  const Eigen::Matrix3d turn = sole.in_link().linear();
  ir::Scene scene;
  scene.placed = {sole};
  scene.outputs = {ir::Quantity::inverse_dynamics, ir::Quantity::inverse_dynamics_dq, ir::Quantity::mass_matrix,
                   ir::Quantity::constraint_jacobian, ir::Quantity::constraint_bias};
  for (const bool in_world : {false, true}) {
    ir::Scene by_link = scene, by_frame = scene;
    by_frame.payloads = by_frame.jacobians = {"sole"};
    by_link.payloads = {link};
    by_frame.wrenches = {{"sole", in_world}};
    by_link.wrenches = {{link, in_world}};
    by_frame.contacts = {{"foot", "sole", ir::ContactType::weld, {0.1, 0, 0}, in_world}};
    by_link.contacts = {{"foot", link, ir::ContactType::weld, sole.in_link() * Eigen::Vector3d(0.1, 0, 0), in_world}};
    const Model framed = model_of(description, by_frame), linked = model_of(description, by_link);
    expect_generic_values(framed, tool);
    State at_frame = some_state(framed.tree), at_link = at_frame;
    ir::KinematicTree loaded = linked.tree;
    Payload moved = tool;
    const Eigen::Vector3d center = sole.in_link() * Eigen::Vector3d(tool[1], tool[2], tool[3]);
    std::copy(center.begin(), center.end(), &moved[1]);
    Eigen::Matrix3d inertia;
    inertia << tool[4], tool[5], tool[6], tool[5], tool[7], tool[8], tool[6], tool[8], tool[9];
    inertia = (turn * inertia * turn.transpose()).eval();
    std::copy_n(std::array{inertia(0, 0), inertia(0, 1), inertia(0, 2), inertia(1, 1), inertia(1, 2), inertia(2, 2)}.begin(), 6,
                &moved[4]);
    Model loaded_frame = framed, loaded_link = linked;
    loaded_frame.tree = welded(framed.tree, "sole", tool);
    loaded_link.tree = welded(linked.tree, link, moved);
    const auto generic = [](const Model& model, ir::Quantity quantity, const State& state) {
      return evaluate_generic(model, output_named(model, std::string(ir::name_of(quantity))), state);
    };
    const Eigen::Vector3d force = at_frame.wrenches.head<3>(), moment = at_frame.wrenches.tail<3>();
    if (in_world) {
      Model frames = framed;
      const Eigen::MatrixXd pose = evaluate_generic(frames, output_named(frames, "pose_" + link), at_frame);
      at_link.wrenches << force, moment + Eigen::Vector3d(pose.leftCols(3) * sole.xyz).cross(force);
    } else {
      at_link.wrenches << turn * force, turn * moment + sole.xyz.cross(turn * force);
    }
    for (const ir::Quantity quantity : scene.outputs) {
      // A wrench along the world's axes keeps to its point: what that adds differs between the two points.
      if (in_world && quantity == ir::Quantity::inverse_dynamics_dq) continue;
      Eigen::MatrixXd theirs = generic(loaded_link, quantity, at_link);
      if (in_world && !theirs.isZero() && theirs.rows() == 6)  // rows along the contact's own axes
        for (Eigen::Index block : {0, 3}) theirs.middleRows(block, 3) = (turn.transpose() * theirs.middleRows(block, 3)).eval();
      EXPECT_LE((generic(loaded_frame, quantity, at_frame) - theirs).cwiseAbs().maxCoeff(),
                1e-12 * std::max(theirs.cwiseAbs().maxCoeff(), 1.0))
          << ir::name_of(quantity) << (in_world ? ", world" : ", link");
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

// With gains, which the generic engine knows nothing of: along a direction, against differences of the sixth order.
TEST(AlgorithmAt, DerivativesWithConstraintsDrawnToTheirPlacesAreDifferences) {
  const auto pose = [](double x, double angle) {
    Eigen::Isometry3d at = Eigen::Translation3d(x, 0.1, -0.2) * Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, -2) / 3);
    return at;
  };
  Gains gains;
  gains.kp = 40;
  gains.kd = 7;
  const double anchor[] = {0.3, -0.2, 0.1, 0.36, -0.48, 0.64, 0.48};
  std::copy(std::begin(anchor), std::end(anchor), gains.anchor);
  for (const std::string name : {"quadruped", "chain_7", "grippers"}) {
    const bool floating = name == "quadruped", arms = name == "grippers";
    const ir::RobotDescription description = robot(name);
    std::vector<std::string> moved;
    for (const ir::Joint& joint : description.joints)
      if (joint.type != ir::JointType::fixed) moved.push_back(description.links[static_cast<size_t>(joint.child)].name);
    const std::string last = moved.back(), middle = moved[moved.size() / 2];
    ir::Scene scene;
    scene.base = floating ? ir::Base::floating : ir::Base::fixed;
    scene.gravity = {0.7, -1.3, -9.81};
    scene.outputs = {ir::Quantity::constrained_forward_dynamics,
                     ir::Quantity::constraint_forces,
                     ir::Quantity::constrained_forward_dynamics_dq,
                     ir::Quantity::constrained_forward_dynamics_dv,
                     ir::Quantity::constraint_forces_dq,
                     ir::Quantity::constraint_forces_dv};
    std::vector<ir::Scene> scenes;
    const auto add = [&](const std::vector<ir::Contact>& contacts, const std::vector<ir::Loop>& loops) {
      scenes.push_back(scene);
      scenes.back().contacts = contacts;
      scenes.back().loops = loops;
    };
    add({{"tip", last, ir::ContactType::point, {0.1, -0.2, 0.05}, false}}, {});
    add({{"tip", last, ir::ContactType::point, {0.1, -0.2, 0.05}, true}}, {});
    add({}, {{"tie", {middle, last}, {pose(0.1, 0.4), pose(-0.2, 1)}, ir::LoopType::distance, 0.4}});
    add({}, {{"ball", {middle, last}, {pose(0.1, 0.4), pose(-0.2, 1)}, ir::LoopType::point, {}}});
    if (floating) {
      add({{"foot", last, ir::ContactType::weld, {0.1, -0.2, 0.05}, false},
           {"toe", middle, ir::ContactType::point, {0.1, 0, 0.05}, true}},
          {});
      add({{"foot", last, ir::ContactType::weld, {0.1, -0.2, 0.05}, true}}, {});
      add({{"toe", middle, ir::ContactType::point, {0.1, 0, 0.05}, false}},
          {{"slide", {middle, last}, {pose(0.1, 0.4), pose(-0.2, 1)}, ir::LoopType::cylinder, {}}});
    }
    if (arms) {
      const std::string other = moved[moved.size() / 2 - 1];
      add({}, {{"rod", {last, other}, {pose(0.1, 0.4), pose(-0.2, 1)}, ir::LoopType::weld, {}}});
      add({}, {{"grip", {other, last}, {pose(0.1, 0.4), pose(-0.2, 1)}, ir::LoopType::hinge, {}}});
    }
    for (size_t which = 0; which < scenes.size(); ++which) {
      SCOPED_TRACE(name + ", " + std::to_string(which));
      const Model model = model_of(description, scenes[which]);
      const State state = some_state(model.tree);
      const ir::EmittedFunction all = ir::functions_of(model.scene).front();
      ir::EmittedFunction motion = all;
      motion.quantities = {ir::Quantity::constrained_forward_dynamics, ir::Quantity::constraint_forces};
      Eigen::VectorXd along(model.tree.nv());
      for (Eigen::Index i = 0; i < along.size(); ++i) along[i] = std::cos(0.3 + 1.1 * static_cast<double>(i));
      const auto moved_by = [&](double step, bool by_q) {
        State there = state;
        if (by_q) integrators::move(state.q, Eigen::VectorXd(step * along), there.q);
        else there.v += step * along;
        const ir::Arrays found = run_function(motion, model, there, {}, gains)[0];
        return std::pair(Eigen::VectorXd(found.at("constrained_forward_dynamics")),
                         Eigen::VectorXd(found.at("constraint_forces")));
      };
      const auto derived = run_function(all, model, state, {}, gains);
      for (const bool by_q : {true, false}) {
        SCOPED_TRACE(by_q ? "q" : "v");
        std::vector<Eigen::VectorXd> accelerations, forces;
        for (const double step : {0.02, 0.01, 0.005}) {
          const auto more = moved_by(step, by_q), less = moved_by(-step, by_q);
          accelerations.emplace_back((more.first - less.first) / (2 * step));
          forces.emplace_back((more.second - less.second) / (2 * step));
        }
        const auto limit = [](const std::vector<Eigen::VectorXd>& d) -> Eigen::VectorXd {
          const Eigen::VectorXd one = (4 * d[1] - d[0]) / 3, two = (4 * d[2] - d[1]) / 3;
          return (16 * two - one) / 15;
        };
        for (const size_t form : {0u, 1u}) {
          const auto near = [&](const char* name, const Eigen::VectorXd& expected) {
            const Eigen::VectorXd ours = derived[form].at(std::string(name) + (by_q ? "_dq" : "_dv")) * along;
            EXPECT_LE((ours - expected).cwiseAbs().maxCoeff<Eigen::PropagateNaN>(), 1e-7 * expected.cwiseAbs().maxCoeff())
                << name << (form == 0 ? ", straight" : ", rolled");
          };
          near("constrained_forward_dynamics", limit(accelerations));
          near("constraint_forces", limit(forces));
        }
      }
    }
  }
}

// Links and frames that are called as contacts, loops and places of other links are among roles: each result is of its own.
TEST(NamesOfLinks, MayBeThoseOfContactsAndLoops) {
  std::string text = "<robot name='r'><link name='base'/>", parent = "base";
  int joint = 0;
  for (const std::string name :
       {"a", "tip", "ground_tip", "contact_c", "own_contact_c", "loop_l_a", "ground_contact_c", "twist"}) {
    text += "<link name='" + name +
            "'><inertial><origin xyz='0.1 0.02 0'/><mass value='1'/><inertia ixx='0.1' iyy='0.12' izz='0.15' ixy='0'"
            " ixz='0' iyz='0'/></inertial></link><joint name='j" +
            std::to_string(joint) + "' type='continuous'><parent link='" + parent + "'/><child link='" + name +
            "'/><origin xyz='0.3 0 0.1'/><axis xyz='" + (joint % 2 == 0 ? "0 0 1" : "0 1 0") + "'/></joint>";
    parent = name, ++joint;
  }
  Diagnostics warnings;
  const ir::RobotDescription robot = frontend::read_urdf_text("r.urdf", text + "</robot>", warnings);
  ir::Scene scene;
  scene.outputs = {ir::Quantity::constraint_jacobian, ir::Quantity::constraint_bias, ir::Quantity::impact,
                   ir::Quantity::constrained_forward_dynamics};
  scene.contacts = {{"c", "a", ir::ContactType::point, {0.1, 0.2, 0}, false}};
  ir::Loop loop;
  loop.name = "l", loop.links = {"tip", "ground_contact_c"}, loop.type = ir::LoopType::point;
  scene.loops = {loop};
  for (const ir::LinkQuantityRow& row : ir::link_quantities())
    for (const char* link : {"tip", "ground_tip", "contact_c", "own_contact_c", "loop_l_a", "ground_contact_c", "twist"})
      scene.frames.push_back({row.quantity, link});
  for (const ir::Base base : {ir::Base::fixed, ir::Base::floating}) {
    scene.base = base;
    expect_generic_values(model_of(robot, scene));
    ir::Scene one = scene;
    one.frames = {{ir::LinkQuantity::jacobian, "ground_tip"}, {ir::LinkQuantity::pose, "tip"}};
    expect_generic_values(model_of(robot, one));
    one.frames = {{ir::LinkQuantity::twist, "contact_c"}};
    one.contacts.front().link = "contact_c";
    expect_generic_values(model_of(robot, one));
    ir::Scene beside;  // of which both have roles called after accelerations and twists
    beside.base = base;
    beside.functions = {{"f",
                         {ir::Quantity::inverse_dynamics_dq, ir::Quantity::inverse_dynamics_dv},
                         {{ir::LinkQuantity::acceleration_bias, "twist"}}}};
    expect_generic_values(model_of(robot, beside));
  }
}

}  // namespace
}  // namespace dalembert
