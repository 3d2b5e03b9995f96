// Each scene of examples/scenes, compiled: right, reading only what it says it reads, and holding only what it needs.
#include "scene_examples.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>

#include "arm_payload/c_api.h"
#include "code_size.hpp"
#include "commands/generated_engine.hpp"
#include "commands/generic_engine.hpp"
#include "compile.hpp"
#include "costs.hpp"
#include "ir/rotation.hpp"
#include "left_out.hpp"
#include "passes/build_tree.hpp"

namespace dalembert::scenes {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

class SceneExample : public testing::TestWithParam<std::string> {};

TEST_P(SceneExample, EqualsTheGenericEngineOnTheReducedModel) {
  const Example& e = example(GetParam());
  EXPECT_EQ(e.results.size(), outputs_of(e.model).size());
  EXPECT_LE(error_of(e, random_states(e.model.tree, 20)), 1e-12);
}

// Every input that the report calls not read is NaN: no bit of any result changes.
TEST_P(SceneExample, ReadsNothingThatTheReportSaysIsNotRead) {
  const Example& e = example(GetParam());
  const OperationCost cost = operation_costs(e.model).front();
  const std::shared_ptr<void> clean = e.workspace(), poisoned = e.workspace();
  for (State state : random_states(e.model.tree, 3)) {
    e.evaluate(state.q.data(), state.v.data(), clean.get());
    for (int i : cost.positions_not_read) state.q[i] = nan;
    for (int i : cost.velocities_not_read) state.v[i] = nan;
    e.evaluate(state.q.data(), state.v.data(), poisoned.get());
    for (const auto& [output, result] : e.results) {
      const double *a = result(clean.get()), *b = result(poisoned.get());
      EXPECT_TRUE(std::equal(a, a + output.rows * output.columns, b)) << output.name;
    }
  }
}

TEST_P(SceneExample, TheWorkspaceHasTheBytesReported) {
  const Example& e = example(GetParam());
  EXPECT_EQ(left_out(e.model, lower(e.model)).back(), "Workspace: " + std::to_string(e.workspace_bytes) + " bytes");
}

// What `nm` says of the static library, one symbol a line: without the self-test, which is linked only where it is called.
std::vector<std::string> symbols(const std::string& archive) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(("'" NM "' -C '" + archive + "'").c_str(), "r"), pclose);
  std::vector<std::string> lines;
  char buffer[4096];
  bool counted = true;
  while (pipe && std::fgets(buffer, sizeof buffer, pipe.get())) {
    const std::string line = buffer;  // "dynamics.cpp.o:" or "address type name"
    if (line.ends_with(".o:\n")) counted = !line.starts_with("self_test");
    if (counted) lines.push_back(line);
  }
  return lines;
}

bool mentioned(const std::vector<std::string>& lines, const std::string& word) {
  return std::any_of(lines.begin(), lines.end(), [&](const std::string& line) { return line.find(word) != line.npos; });
}

TEST_P(SceneExample, TheLibraryHasNoSymbolOfWhatIsLeftOut) {
  const Example& e = example(GetParam());
  const std::vector<std::string> all = symbols(e.archive);
  ASSERT_TRUE(mentioned(all, "evaluate")) << e.archive;
  EXPECT_FALSE(mentioned(all, "tbb"));
  for (const backend::OutputFile& file : compile(e.model)) {
    EXPECT_EQ(file.text.find("tbb"), std::string::npos) << file.name;
    EXPECT_FALSE(file.name.starts_with("tasks"));
  }
  for (const ir::QuantityRow& row : ir::quantities()) {
    const bool wanted = std::count(e.model.scene.outputs.begin(), e.model.scene.outputs.end(), row.quantity) > 0;
    EXPECT_EQ(mentioned(all, e.name + "_" + row.name), wanted) << row.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Examples, SceneExample,
                         testing::Values("arm_gravity", "arm_mass_matrix", "planar_biped", "legs_only", "full_humanoid"),
                         [](const auto& info) { return info.param; });

TEST(SceneExamples, WhatTheNanTestsRestOn) {
  const OperationCost gravity = operation_costs(example("arm_gravity").model).front();
  EXPECT_EQ(gravity.velocities_not_read.size(), 6u);
  const OperationCost mass = operation_costs(example("arm_mass_matrix").model).front();
  EXPECT_EQ(mass.velocities_not_read.size(), 6u);
  EXPECT_EQ(mass.positions_not_read, std::vector<int>{0});
  const OperationCost full = operation_costs(example("full_humanoid").model).front();
  EXPECT_EQ(full.positions_not_read, (std::vector<int>{0, 1, 2}));
  const OperationCost matrices = operation_costs(example("full_mass_coriolis").model).front();
  EXPECT_EQ(matrices.positions_not_read, (std::vector<int>{0, 1, 2, 3, 4, 5, 6}));
}

// A gravity-only library holds the function, its C shell and nothing that a Coriolis matrix needs.
TEST(SceneExamples, GravityAloneHasNothingOfC) {
  const std::vector<std::string> all = symbols(example("arm_gravity").archive);
  for (const char* word : {"coriolis", "bias", "mass_matrix", "kinematics", "blocks", "table"})
    EXPECT_FALSE(mentioned(all, word)) << word;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers add data of their own";
#endif
  for (const std::string& line : all)  // d, b, r: data, zeroed data, tables; .LC are literals of the code
    EXPECT_TRUE(line.size() < 18 || std::string("DdBbRr").find(line[17]) == line.npos || line.find(" .LC") != line.npos)
        << line;
  // Of read-only data there is no more than the literals of its own few dozen operations, some of them in pairs.
  const benchmarks::CodeSize gravity = benchmarks::code_size(example("arm_gravity").archive);
  const benchmarks::CodeSize full = benchmarks::code_size(example("full_humanoid").archive);
  EXPECT_LE(gravity.tables, 16 * operation_costs(example("arm_gravity").model).front().operations.total());
  EXPECT_LE(10 * (gravity.text + gravity.tables), full.text + full.tables);
}

TEST(SceneExamples, LegsOnlyTakeAtMost60PercentOfTheOperations) {
  const ir::Operations legs = operation_costs(example("legs_only").model).front().operations;
  const ir::Operations full = operation_costs(example("full_mass_coriolis").model).front().operations;
  EXPECT_LE(static_cast<double>(legs.total()), 0.6 * static_cast<double>(full.total()));
}

// At rest, whatever form is asked for, velocities are not even read; and without gravity nothing of it is computed.
TEST(Statics, BiasIsGravityAndVelocitiesAreNotRead) {
  Request request;
  request.robot = example("full_humanoid").model.description.file;
  request.settings = {{"outputs", "bias,gravity"}, {"rates_zero", "true"}};
  request.form = "rolled";
  Diagnostics warnings;
  const Model model = read_model(request, warnings);
  const std::vector<Output> outputs = outputs_of(model);
  GeneratedEngine engine(model, outputs, {.compiler = "", .flags = "-std=c++17 -O1"});
  for (State state : random_states(model.tree, 5)) {
    const Eigen::MatrixXd expected = evaluate_generic(model, outputs[1], state);
    state.v.setConstant(nan);
    engine.evaluate(state);
    for (const Output& output : outputs)
      EXPECT_LE((engine.result(output) - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.cwiseAbs().maxCoeff())
          << output.name;
  }
}

TEST(Statics, WithoutGravityTheRolledFormHasNothingOfIt) {
  Request request;
  request.robot = example("full_humanoid").model.description.file;
  request.settings = {{"outputs", "mass_matrix,gravity"}, {"gravity", "none"}};
  request.form = "rolled";
  Diagnostics warnings;
  const ir::RolledProgram with_none = lower(read_model(request, warnings)).functions.front().first().rolled;
  request.settings.back().text = "0,0,-9.81";
  const ir::RolledProgram with_some = lower(read_model(request, warnings)).functions.front().first().rolled;
  EXPECT_LT(with_none.arrays.size(), with_some.arrays.size());
}

struct Payload {
  double mass;
  Eigen::Vector3d com;
  Eigen::Matrix3d inertia;  // about the centre of mass
};

// The model with the payload welded to the link by a fixed joint, as a URDF would have it.
Model welded(Model model, const std::string& link, const Payload& payload, const std::vector<ir::Quantity>& outputs) {
  ir::RobotDescription& robot = model.description;
  const auto at = std::find_if(robot.links.begin(), robot.links.end(), [&](const ir::Link& l) { return l.name == link; });
  ir::Joint weld;
  weld.name = "weld";
  weld.parent = static_cast<int>(at - robot.links.begin());
  weld.child = static_cast<int>(robot.links.size());
  robot.links.push_back({"payload", ir::Inertia{payload.mass, payload.com, payload.inertia}});
  robot.children.emplace_back();
  robot.children[static_cast<size_t>(weld.parent)].push_back(static_cast<int>(robot.joints.size()));
  robot.joints.push_back(weld);
  model.scene.payloads.clear();
  model.scene.outputs = outputs;
  Diagnostics warnings;
  model.tree = passes::build_tree(robot, model.scene, warnings);
  return model;
}

TEST(Payload, GivenAtRunTimeEqualsTheSameWeldedOn) {
  Eigen::Matrix3d inertia;
  inertia << 0.02, 0.003, -0.001, 0.003, 0.03, 0.002, -0.001, 0.002, 0.025;
  const Payload payload{1.7, {0.03, -0.02, 0.11}, inertia};
  const double packed[] = {0.02, 0.003, -0.001, 0.03, 0.002, 0.025};
  const Model model = welded(example("arm_gravity").model, "right_hand", payload, ir::Scene{}.outputs);
  const std::vector<Output> outputs = outputs_of(model);
  ASSERT_EQ(outputs.size(), 4u);
  GeneratedEngine generated(model, outputs, {.compiler = "", .flags = "-std=c++17 -O1"});

  const std::unique_ptr<arm_payload_workspace, void (*)(arm_payload_workspace*)> workspace(arm_payload_create(),
                                                                                           arm_payload_destroy);
  arm_payload_set_payload_right_hand(payload.mass, payload.com.data(), packed, workspace.get());
  const double* values[] = {arm_payload_mass_matrix(workspace.get()), arm_payload_coriolis_matrix(workspace.get()),
                            arm_payload_gravity(workspace.get()), arm_payload_bias(workspace.get())};
  double without = 0;  // how much the payload changes: the test is about something
  const Model empty_handed =
      welded(example("arm_gravity").model, "right_hand", {1e-9, {0, 0, 0}, Eigen::Matrix3d::Zero()}, ir::Scene{}.outputs);
  for (const State& state : random_states(model.tree, 20)) {
    arm_payload_evaluate(state.q.data(), state.v.data(), workspace.get());
    generated.evaluate(state);
    for (size_t i = 0; i < 4; ++i) {
      SCOPED_TRACE(outputs[i].name);
      const Eigen::Map<const Eigen::MatrixXd> value(values[i], outputs[i].rows, outputs[i].columns);
      const Eigen::MatrixXd generic = evaluate_generic(model, outputs[i], state);
      const double tolerance = 1e-12 * generic.cwiseAbs().maxCoeff();
      EXPECT_LE((value - generic).cwiseAbs().maxCoeff(), tolerance);
      EXPECT_LE((value - generated.result(outputs[i])).cwiseAbs().maxCoeff(), tolerance);
      without = std::max(without, (value - evaluate_generic(empty_handed, outputs[i], state)).cwiseAbs().maxCoeff());
    }
  }
  EXPECT_GT(without, 1);
}

}  // namespace
}  // namespace dalembert::scenes
