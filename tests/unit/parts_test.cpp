// Parts of results: rows and columns of some joints, columns of some links. What is not asked for costs nothing.
#include <gtest/gtest.h>

#include "both_forms.hpp"
#include "compile.hpp"
#include "costs.hpp"
#include "frontend/scene_check.hpp"
#include "frontend/scene_reader.hpp"
#include "pipeline.hpp"

namespace dalembert {
namespace {

using ir::Quantity;

const std::vector<Quantity> of_joints{Quantity::mass_matrix,
                                      Quantity::coriolis_matrix,
                                      Quantity::gravity,
                                      Quantity::bias,
                                      Quantity::center_of_mass_jacobian,
                                      Quantity::momentum_matrix,
                                      Quantity::inverse_dynamics,
                                      Quantity::regressor,
                                      Quantity::wrench_influence};

Model mahru(const std::string& scene, const std::vector<frontend::Setting>& settings = {}) {
  Request request;
  request.robot = MAHRU;
  request.settings = settings;
  request.settings.push_back({"outputs", scene});
  Diagnostics warnings;
  return read_model(request, warnings);
}

// The results of both forms, whole, have the part's rows and columns: to rounding, since what is left of a robot may be
// computed in other frames.
void expect_rows_of_whole(const Model& model) {
  Model whole = model;
  whole.scene.parts.clear();
  for (ir::LinkOutput& output : whole.scene.frames) output.part.reset();
  const State state = some_state(model.tree);
  const auto parts = run_both(model, state, {}), wholes = run_both(whole, state, {});
  for (const Output& output : outputs_of(model))
    for (size_t form : {0u, 1u}) {
      SCOPED_TRACE(output.name + (form == 0 ? ", straight" : ", rolled"));
      const Eigen::MatrixXd& result = wholes[form].at(output.name);
      const Eigen::MatrixXd selected = output.selection().of(result);
      const Eigen::MatrixXd& part = parts[form].at(output.name);
      ASSERT_EQ(part.rows(), output.rows);
      ASSERT_EQ(part.cols(), output.columns);
      ASSERT_EQ(part.rows(), selected.rows());
      ASSERT_EQ(part.cols(), selected.cols());
      EXPECT_LE((part - selected).cwiseAbs().maxCoeff<Eigen::PropagateNaN>(),
                4e-14 * std::max(1.0, result.cwiseAbs().maxCoeff()));
    }
}

// Parts by every way to name them, on robots of every shape, together and each alone.
TEST(Parts, AreRowsAndColumnsOfTheWholeInBothForms) {
  for (const char* name : {"two_levels_of_branching", "three_branches_at_base", "unequal_limbs", "prismatic_mix", "chain_7",
                           "quadruped", "hand", "mahru"})
    for (const ir::Base base : {ir::Base::fixed, ir::Base::floating}) {
      const ir::RobotDescription description = robot(name);
      std::vector<std::string> joints;
      for (const ir::Joint& joint : description.joints)
        if (joint.type != ir::JointType::fixed) joints.push_back(joint.name);
      const std::string middle = link_moved_by(description, joints[joints.size() / 2]);
      ir::Part subtree, scattered, first;
      subtree.subtrees = {middle};
      for (size_t i = 0; i < joints.size(); i += 3) scattered.joints.push_back(joints[i]);
      if (base == ir::Base::floating) scattered.base = true;
      first.joints = {joints.front()};
      for (const ir::Part& part : {subtree, scattered, first}) {
        SCOPED_TRACE(std::string(name) + (base == ir::Base::fixed ? ", fixed" : ", floating"));
        ir::Scene scene;
        scene.base = base;
        scene.outputs = of_joints;
        for (const Quantity quantity : of_joints) {
          scene.parts[quantity] = part;
          if (ir::parts_of(quantity).of_links) scene.parts[quantity].links = {middle};
        }
        scene.frames = {{ir::LinkQuantity::jacobian_mixed, middle, part}, {ir::LinkQuantity::pose, middle}};
        expect_rows_of_whole(model_of(description, scene));
        for (const Quantity quantity :
             {Quantity::mass_matrix, Quantity::coriolis_matrix, Quantity::bias, Quantity::regressor}) {
          ir::Scene alone = scene;
          alone.outputs = {quantity};
          alone.frames.clear();
          expect_rows_of_whole(model_of(description, alone));
        }
        scene.parts.erase(Quantity::bias);  // beside what is wanted whole
        scene.outputs = {Quantity::mass_matrix, Quantity::coriolis_matrix, Quantity::bias};
        expect_rows_of_whole(model_of(description, scene));
      }
    }
}

// Rows of different joints in one function.
TEST(Parts, OfDifferentJointsStandBesideOneAnother) {
  const ir::RobotDescription description = robot("mahru");
  for (const ir::Base base : {ir::Base::fixed, ir::Base::floating}) {
    ir::Scene scene;
    scene.base = base;
    scene.outputs = {Quantity::mass_matrix, Quantity::coriolis_matrix};
    ir::Part arm, legs;
    arm.joints = {"left_shoulder_*", "left_elbow"};
    legs.joints = {"*_knee", "waist"};
    scene.parts = {{Quantity::mass_matrix, arm}, {Quantity::coriolis_matrix, legs}};
    expect_rows_of_whole(model_of(description, scene));
    scene.mimic["right_knee"] = {"left_knee", -0.5, 0.2};
    expect_rows_of_whole(model_of(description, scene));
  }
}

long operations(const Model& model) {
  const ir::Operations o = operation_costs(model).front().operations;
  return o.total() + o.sincos;
}

const char* const arm = "[{mass_matrix: {subtree: left_shoulder_pitch_link}}]";

TEST(Parts, OfASubtreeHaveTheMotorOfAnElasticJoint) {
  const auto rows = [](const std::string& part) {
    const Model model = mahru("[{mass_matrix: " + part + "}]", {{"elastic", "{left_elbow: {k: 300, inertia: 0.2}}"}});
    return model.scene.parts.begin()->second.coordinates;
  };
  const Model whole = mahru("mass_matrix");
  const auto elbow = std::find_if(whole.tree.bodies.begin(), whole.tree.bodies.end(),
                                  [](const ir::Body& b) { return b.joint == "left_elbow"; });
  const std::vector<int> all = rows("{subtree: " + elbow->name + "}");
  EXPECT_EQ(all, rows("{joints: [left_elbow, left_wrist_*]}"));
  EXPECT_GE(all.size(), 2u);
}

TEST(Parts, AnArmsRowsOfMCostNoMoreThanTheArmAlone) {
  const Model part = mahru(arm);
  std::string others = "{";
  for (const ir::Body& body : part.tree.bodies)
    if (body.joint.find("left_") != 0 || body.joint.find("hip") != body.joint.npos ||
        body.joint.find("knee") != body.joint.npos || body.joint.find("ankle") != body.joint.npos)
      others += (others.size() > 1 ? ", " : "") + body.joint + ": 0";
  const Model alone = mahru("mass_matrix", {{"base", "fixed"}, {"locked", others + "}"}});
  EXPECT_EQ(alone.tree.nv(), 6);
  EXPECT_LE(static_cast<double>(operations(part)), 1.1 * static_cast<double>(operations(alone)));
  // By the rolled form too, as it is executed.
  const auto executed = [](Model model) {
    model.options.form = ir::Form::rolled;
    return executed_operations(model, lower(model)).front().second.total();
  };
  EXPECT_LE(static_cast<double>(executed(part)), 1.1 * static_cast<double>(executed(alone)));
}

TEST(Parts, AnArmsRowsReadNothingBeyondTheArm) {
  const OperationCost cost = operation_costs(mahru(arm)).front();
  EXPECT_FALSE(cost.reads_base_pose);
  EXPECT_FALSE(cost.reads_velocity);
  // Its own first joint's position is not read either.
  EXPECT_EQ(cost.positions_not_read.size(), 32u - 5u);
  // Rows of the bias need how the arm is carried, and no leg.
  const Model bias = mahru("[{bias: {subtree: left_shoulder_pitch_link}}]");
  const OperationCost of_bias = operation_costs(bias).front();
  EXPECT_TRUE(of_bias.reads_base_pose);
  const std::vector<int> coordinates = bias.tree.coordinates();
  for (const ir::Body& body : bias.tree.bodies) {
    const int position = 7 + coordinates[static_cast<size_t>(&body - bias.tree.bodies.data())];
    const bool read = std::find(of_bias.positions_not_read.begin(), of_bias.positions_not_read.end(), position) ==
                      of_bias.positions_not_read.end();
    const bool of_arm =
        body.joint.starts_with("left_shoulder") || body.joint.starts_with("left_elbow") || body.joint.starts_with("left_wrist");
    EXPECT_EQ(read, of_arm || body.joint == "waist") << body.joint;
  }
}

// What a person reads of it.
TEST(Parts, AreSaidInTheHeader) {
  for (const ir::Form form : {ir::Form::straight, ir::Form::rolled}) {
    Model model = mahru("[{mass_matrix: {subtree: left_shoulder_pitch_link}}, {regressor: {links: [left_hand]}}]");
    model.options.form = form;
    std::string header, c_api;
    for (const backend::OutputFile& file : compile_without_self_test(model)) {
      if (file.name == "dynamics.hpp") header = file.text;
      if (file.name == "c_api.h") c_api = file.text;
    }
    for (const std::string& text : {header, c_api}) {
      std::string flat = text;
      for (size_t at; (at = flat.find("\n// ")) != flat.npos;) flat.replace(at, 4, " ");
      EXPECT_NE(flat.find("rows and columns: left_shoulder_pitch to left_wrist_pitch"), flat.npos) << text;
      EXPECT_NE(flat.find("columns: left_hand"), flat.npos);
    }
    EXPECT_NE(header.find("Result<6, 6> mass_matrix("), header.npos);
    EXPECT_NE(header.find("Result<31, 10> regressor("), header.npos);
  }
}

// What the scene's reader, its check, or the tree refuses; "": nothing.
std::string refusal(const std::string& outputs, const std::vector<frontend::Setting>& settings = {}) {
  try {
    mahru(outputs, settings);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(Parts, MisspeltAndEmptyOnesAreRefused) {
  const auto expect = [](const std::string& said, const char* word) { EXPECT_NE(said.find(word), said.npos) << said; };
  expect(refusal("[{mass_matrix: {joints: [left_elbo]}}]"), "did you mean 'left_elbow'");
  expect(refusal("[{mass_matrix: {joints: [left_arm_*]}}]"), "no joint that moves is called like 'left_arm_*'");
  expect(refusal("[{mass_matrix: {joints: []}}]"), "no joints of mass_matrix are named");
  expect(refusal("[{mass_matrix: {}}]"), "is not said");
  expect(refusal("[{mass_matrix: [left_elbow]}]"), "no map");
  expect(refusal("[{mass_matrix: {joint: [left_elbow]}}]"), "did you mean 'joints'");
  expect(refusal("[{mass_matrix: {links: [left_hand]}}]"), "has no columns of links");
  expect(refusal("[{mass_matrx: {joints: [left_elbow]}}]"), "did you mean 'mass_matrix'");
  expect(refusal("[{mass_matrix: {subtree: left_hnd}}]"), "did you mean 'left_hand'");
  expect(refusal("[{regressor: {links: [left_hnd]}}]"), "did you mean 'left_hand'");
  expect(refusal("[{regressor: {links: [head]}}]"), "name 'torso'");
  expect(refusal("[{mass_matrix: {joints: [left_elbow]}}]", {{"locked", "left_elbow"}}), "is locked");
  expect(refusal("[{mass_matrix: {joints: [left_elbow]}}]", {{"mimic", "{left_elbow: {of: right_elbow}}"}}),
         "name 'right_elbow'");
  // The hand is one body with the wrist then, which another joint moves.
  EXPECT_EQ(refusal("[{mass_matrix: {subtree: left_hand}}]", {{"locked", "left_wrist_pitch"}}), "");
  expect(refusal("[{mass_matrix: {joints: [left_elbow], base: true}}]", {{"base", "fixed"}}), "the base is fixed");
  for (const char* whole : {"forward_dynamics", "inverse_mass_matrix", "inverse_dynamics_dq", "kinetic_energy"})
    expect(refusal(std::string("[{") + whole + ": {joints: [left_elbow]}}]"), "cannot be asked for");
  expect(refusal("[mass_matrix]", {{"frames", "{left_hand: [{pose: {joints: [left_elbow]}}]}"}}), "cannot be asked for");
  EXPECT_EQ(refusal("[{crba: {joints: left_elbow}}, bias]", {{"frames", "{left_hand: [{jacobian: {joints: [left_*]}}]}"}}), "");
}

}  // namespace
}  // namespace dalembert
