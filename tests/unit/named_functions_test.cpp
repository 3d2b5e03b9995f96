// Functions that a scene names: what they take, what they share, and what they leave alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <robots.hpp>
#include <set>
#include <string_view>

#include "compile.hpp"
#include "costs.hpp"
#include "frontend/function_names.hpp"
#include "frontend/urdf_reader.hpp"
#include "lower.hpp"
#include "passes/build_tree.hpp"
#include "passes/normalise.hpp"
#include "passes/quantities/quantities.hpp"

namespace dalembert {
namespace {

using ir::Quantity;

Model model_of(const ir::Scene& scene) {
  Diagnostics warnings;
  Model model;
  model.name = "r";
  for (const TestRobot& robot : test_robots)
    if (robot.name == std::string_view("two_levels_of_branching"))
      model.description = frontend::read_urdf(robot.urdf, warnings);
  model.scene = scene;
  model.tree = passes::build_tree(model.description, scene, warnings);
  return model;
}

ir::Scene scene_of(std::vector<Quantity> outputs, std::vector<ir::NamedFunction> functions) {
  ir::Scene scene;
  scene.outputs = std::move(outputs);
  scene.functions = std::move(functions);
  return scene;
}

const std::vector<Quantity> derivatives{Quantity::forward_dynamics_dq, Quantity::forward_dynamics_dv,
                                        Quantity::inverse_mass_matrix};

TEST(NamedFunctions, TakeWhatTheirQuantitiesTake) {
  EXPECT_STREQ(ir::named_function("f", {Quantity::mass_matrix, Quantity::gravity}).input(), "");
  EXPECT_STREQ(ir::named_function("f", {Quantity::mass_matrix, Quantity::regressor}).input(), "a");
  EXPECT_STREQ(ir::named_function("f", {Quantity::forward_dynamics_dv, Quantity::gravity}).input(), "tau");
}

TEST(NamedFunctions, ComeBehindTheStandardOnesThatTheOutputsNeed) {
  const auto names = [](const ir::Scene& scene) {
    std::vector<std::string> names;
    for (const ir::EmittedFunction& f : ir::functions_of(scene)) names.push_back(f.name);
    return names;
  };
  const std::vector<ir::NamedFunction> two{{"plan_step", derivatives}, {"balance", {Quantity::mass_matrix}}};
  using Names = std::vector<std::string>;
  EXPECT_EQ(names(scene_of({}, two)), (Names{"plan_step", "balance"}));
  EXPECT_EQ(names(scene_of({Quantity::regressor, Quantity::bias}, two)),
            (Names{"evaluate", "inverse_dynamics", "plan_step", "balance"}));
  EXPECT_EQ(ir::functions_of(scene_of({}, two)).front().type, "PlanStep");
}

void expect_order_asked_for(const ir::Scene& scene) {
  const Model model = model_of(scene);
  for (const ir::EmittedFunction& function : ir::functions_of(scene)) {
    std::vector<std::string> asked, given;
    for (const Quantity quantity : function.quantities) asked.push_back(function.result(quantity));
    for (const ir::LinkOutput& output : function.of_links) asked.push_back(function.result(output));
    const ir::NormalTree normal = passes::normalise(model.tree, passes::normalise_options(scene, true));
    const std::vector<ir::Algorithm> sections = passes::describe(function, model.tree, normal, scene, {});
    for (const ir::OutputArray& array : sections.back().arrays)
      if (!array.internal) given.push_back(array.name);
    EXPECT_EQ(given, asked);
  }
}

// The self-test knows them by their number.
TEST(NamedFunctions, GiveResultsInTheOrderAskedFor) {
  for (const bool factors : {false, true}) {
    std::vector<Quantity> outputs{Quantity::inverse_mass_matrix, Quantity::bias, Quantity::mass_matrix};
    if (factors) outputs.insert(outputs.begin() + 1, Quantity::mass_matrix_factor);
    ir::Scene scene = scene_of(outputs, {{"step", outputs, {{ir::LinkQuantity::pose, "c_01"}}}});
    scene.frames = {{ir::LinkQuantity::twist, "c_01"}};
    expect_order_asked_for(scene);
  }
}

// Of what constraints do, much is made for what is asked for before it: the third for the first, with the second between.
TEST(NamedFunctions, GiveResultsWithConstraintsInTheOrderAskedFor) {
  std::vector<Quantity> solved;
  for (const ir::QuantityRow& row : ir::quantities())
    if (row.scale == ir::Scale::constrained && row.function == ir::Function::forward_dynamics) solved.push_back(row.quantity);
  ASSERT_GE(solved.size(), 8u);
  std::vector<ir::NamedFunction> functions;
  for (const Quantity first : solved)
    for (const Quantity second : solved)
      for (const Quantity third : solved)
        if (first != second && second != third && third != first)
          functions.push_back({"f" + std::to_string(functions.size()), {first, second, third}, {}});
  ir::Scene scene = scene_of({}, functions);
  scene.contacts = {{"foot", "c_01", ir::ContactType::point, {0.1, 0, 0}, true}};
  expect_order_asked_for(scene);
}

// What a function keeps between its steps stands in the workspace: no other function may be called like it.
TEST(NamedFunctions, AreNotCalledLikeWhatAnotherKeeps) {
  ir::Scene whole = scene_of(derivatives, {}), in_sections = whole;
  in_sections.mimic["e_02_joint"] = {"c_01_joint", 2, 0};
  std::set<std::string> names;
  for (const ir::Scene& scene : {whole, in_sections})
    for (const LoweredFunction& f : lower(model_of(scene)).functions)
      for (const LoweredSection& s : f.sections) {
        names.insert(s.algorithm.section.name);
        for (const char* word : {"scratch", "stages"}) names.insert(s.algorithm.own_name(word));
        for (const ir::OutputArray& array : s.algorithm.arrays) names.insert(array.name);
      }
  EXPECT_TRUE(names.contains("forward_dynamics_derivatives") && names.contains("forward_dynamics_accelerations"));
  EXPECT_GE(names.size(), 20u);
  for (const char* name : {"derivatives", "accelerations", "inverse_dynamics_derivatives"})
    EXPECT_TRUE(frontend::taken_names(scene_of({}, {{name, {Quantity::gravity}}})).empty()) << name;
  for (const std::string& name : names)
    EXPECT_EQ(frontend::taken_names(scene_of({}, {{name, {Quantity::gravity}}})).size(), 1u) << name;
}

// Nor like what stands in every header, parameters of its templates among it.
TEST(NamedFunctions, AreNotCalledLikeWhatEveryHeaderHas) {
  for (const char* name : {"q_index", "v_index", "Result", "VectorQ", "Q", "Tau", "numbers"})
    EXPECT_EQ(frontend::taken_names(scene_of({}, {{name, {Quantity::gravity}}})).size(), 1u) << name;
}

// Nor so that C's names of results and of rollouts are the same.
TEST(NamedFunctions, AreNotCalledLikeTheRolloutsOfAnother) {
  const std::vector<Quantity> moved{Quantity::forward_dynamics}, held{Quantity::bias};
  EXPECT_EQ(frontend::taken_names(scene_of({}, {{"rollout", moved}})).size(), 1u);
  EXPECT_EQ(frontend::taken_names(scene_of({}, {{"free", moved}, {"rollout_free", held}})).size(), 1u);
  EXPECT_EQ(frontend::taken_names(scene_of({}, {{"rollout_free", held}, {"free", moved}})).size(), 1u);
  EXPECT_TRUE(frontend::taken_names(scene_of({}, {{"free", moved}, {"roll_out", held}})).empty());
}

// Nor like what says how another's constraints fared, which C's interface has a function for; nor what keeps another's
// linkages.
TEST(NamedFunctions, AreNotCalledLikeTheStatusOfAnother) {
  for (const char* name :
       {"constraint_status", "impact_status", "forward_dynamics_impact_status", "inverse_dynamics_support_status"})
    EXPECT_EQ(frontend::taken_names(scene_of({}, {{name, {Quantity::gravity}}})).size(), 1u) << name;
  ir::Scene scene = scene_of({}, {{"lean", {Quantity::mass_matrix}}, {"lean_linkage_status", {Quantity::gravity}}});
  EXPECT_TRUE(frontend::taken_names(scene).empty());
  scene.embedded.emplace_back();
  EXPECT_EQ(frontend::taken_names(scene).size(), 1u);
}

// What depends on the accelerations that M's factors give is a function behind the first, which users do not see; dv'/dv does
// not.
TEST(NamedFunctions, AreComputedInSectionsWhereAccelerationsComeLate) {
  ir::Scene scene = scene_of(derivatives, {{"lean", {Quantity::forward_dynamics_dv}}, {"plan", derivatives}});
  const auto names = [&] {
    std::vector<std::string> names;
    const Lowered lowered = lower(model_of(scene));
    for (const LoweredSection* s : lowered.all_sections()) names.push_back(s->algorithm.section.name);
    return names;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(names(), (Names{"evaluate", "forward_dynamics", "lean", "plan"}));
  scene.mimic["e_02_joint"] = {"c_01_joint", 2, 0};
  EXPECT_EQ(names(),
            (Names{"evaluate", "forward_dynamics", "forward_dynamics_derivatives", "lean", "plan", "plan_derivatives"}));
  const Model model = model_of(scene);
  const Lowered lowered = lower(model);
  std::vector<std::string> executed, costs;
  for (const auto& [name, operations] : executed_operations(model, lowered)) executed.push_back(name);
  EXPECT_EQ(executed, (Names{"evaluate", "forward_dynamics", "lean", "plan"}));
  const std::vector<OperationCost> list = operation_costs(lowered, model.tree);
  const auto cost = [&](const std::string& name) {
    return std::find_if(list.begin(), list.end(), [&](const OperationCost& c) { return c.name == name; })->operations.total();
  };
  EXPECT_EQ(list.size(), 8u);
  EXPECT_EQ(cost("plan_forward_dynamics_dq"), cost("forward_dynamics_dq"));
  EXPECT_GT(cost("forward_dynamics_dq"), cost("inverse_mass_matrix"));
  EXPECT_GT(cost("plan_forward_dynamics_dv"), cost("inverse_mass_matrix"));
  EXPECT_LT(cost("plan_forward_dynamics_dv"), cost("plan_forward_dynamics_dq"));
  // Each section moves the bodies.
  EXPECT_GT(cost("plan_forward_dynamics_dv"), cost("lean_forward_dynamics_dv"));
  EXPECT_LT(5 * cost("plan_forward_dynamics_dv"), 6 * cost("lean_forward_dynamics_dv"));
}

// M is inverted once, and bodies are moved once.
TEST(NamedFunctions, ShareWhatTheyShare) {
  const Lowered apart = lower_to_programs(model_of(scene_of(derivatives, {})));
  const Lowered together = lower_to_programs(model_of(scene_of({}, {{"plan", derivatives}})));
  ASSERT_EQ(apart.functions.size(), 2u);
  ASSERT_EQ(together.functions.size(), 1u);
  const auto inversions = [](const Lowered& lowered) {
    long count = 0;
    for (const LoweredSection* s : lowered.all_sections())
      for (const ir::Kernel& kernel : s->algorithm.kernels) count += kernel.kind == ir::Kernel::Kind::invert ? 1 : 0;
    return count;
  };
  EXPECT_EQ(inversions(apart), 2);
  EXPECT_EQ(inversions(together), 1);
  const ir::KinematicTree tree = model_of({}).tree;
  const ir::Operations two = operation_costs(apart, tree).front().operations,
                       one = operation_costs(together, tree).front().operations;
  EXPECT_LT(one.sincos, two.sincos);
  EXPECT_LT(10 * one.total(), 9 * two.total());
}

// Each result costs what it costs under its own name, whichever function it belongs to.
TEST(NamedFunctions, CostWhatTheirQuantitiesCost) {
  const std::vector<OperationCost> outputs =
      operation_costs(model_of(scene_of({Quantity::mass_matrix, Quantity::momentum_matrix}, {})));
  const std::vector<OperationCost> named =
      operation_costs(model_of(scene_of({}, {{"balance", {Quantity::momentum_matrix, Quantity::mass_matrix}}})));
  ASSERT_EQ(named.size(), outputs.size());
  for (size_t i = 0; i < named.size(); ++i) {
    EXPECT_EQ(named[i].name, i == 0 ? "all" : "balance_" + outputs[i].name);
    EXPECT_EQ(named[i].operations.total(), outputs[i].operations.total()) << named[i].name;
  }
}

// What evaluate() computes, it computes by the same statements.
TEST(NamedFunctions, LeaveTheOutputsAlone) {
  const std::vector<Quantity> outputs{Quantity::mass_matrix, Quantity::coriolis_matrix};
  Model without = model_of(scene_of(outputs, {})), with = model_of(scene_of(outputs, {{"balance", {Quantity::bias}}}));
  without.options.form = with.options.form = ir::Form::straight;
  const auto evaluate = [](const Model& model) {
    for (const backend::OutputFile& file : compile_without_self_test(model)) {
      if (file.name != "dynamics.cpp") continue;
      const size_t begin = file.text.find("void evaluate("), end = file.text.find("\n}\n", begin);
      return file.text.substr(begin, end - begin);
    }
    return std::string();
  };
  EXPECT_GT(evaluate(without).size(), 1000u);
  EXPECT_EQ(evaluate(without), evaluate(with));
}

// A register of states has no place for how a contact holds each of them; what contacts do not touch needs none.
TEST(NamedFunctions, AreCalledStateByStateForDerivativesWhereContactsHoldAndNowhereElse) {
  ir::Scene scene =
      scene_of({Quantity::constrained_forward_dynamics}, {{"free", {Quantity::bias, Quantity::forward_dynamics}},
                                                          {"rows", {Quantity::constraint_jacobian, Quantity::constraint_bias}},
                                                          {"struck", {Quantity::impact}},
                                                          {"borne", {Quantity::constrained_inverse_dynamics}},
                                                          {"response", {Quantity::constrained_forward_dynamics_dtau}},
                                                          {"derived", {Quantity::constraint_forces_dq}}});
  scene.batch = true;
  Model model = model_of(scene);
  model.scene.contacts = {ir::Contact{"tip", model.tree.links.back().link}};
  Diagnostics warnings;
  model.tree = passes::build_tree(model.description, model.scene, warnings);
  std::map<std::string, bool> in_lanes;
  for (const LoweredFunction& f : lower(model).functions) in_lanes[f.name()] = f.batch.has_value();
  EXPECT_EQ(in_lanes, (std::map<std::string, bool>{{"forward_dynamics", true},
                                                   {"free", true},
                                                   {"rows", true},
                                                   {"struck", true},
                                                   {"borne", true},
                                                   {"response", false},
                                                   {"derived", false}}));
}

}  // namespace
}  // namespace dalembert
