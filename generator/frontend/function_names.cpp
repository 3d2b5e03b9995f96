#include "frontend/function_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "ir/emitted_function.hpp"
#include "ir/identifier.hpp"
#include "ir/kernel.hpp"
#include "ir/library_names.hpp"
#include "ir/run_time_inputs.hpp"

namespace dalembert::frontend {

namespace {

// Of every folder: dynamics.hpp, c_api.h behind the robot's name, arguments, self_test.cpp.
constexpr const char* of_the_folder[] = {"Scalar",
                                         "nq",
                                         "nv",
                                         "joints",
                                         "bodies",
                                         "Joint",
                                         "joint_names",
                                         "body_names",
                                         "q_index",
                                         "q_size",
                                         "v_size",
                                         "constraint_rows",
                                         "quaternion_joints",
                                         "v_index",
                                         "VectorQ",
                                         "VectorV",
                                         "Result",
                                         "Payload",
                                         "Contact",
                                         "Loop",
                                         "Batch",
                                         "batch_options",
                                         "batch_error",
                                         "batch_stack",
                                         "Workspace",
                                         "workspace",
                                         "gravity_vector",
                                         "create",
                                         "destroy",
                                         "q",
                                         "v",
                                         "a",
                                         "tau",
                                         "Q",
                                         "V",
                                         "A",
                                         "Tau",
                                         "numbers",
                                         "self_test",
                                         "self_test_report",
                                         "SelfTestReport",
                                         "set_gravity",
                                         "memory",
                                         "taken",
                                         "test",
                                         "report",
                                         "state",
                                         "block",
                                         "width",
                                         "strip",
                                         "q_0",
                                         "q_1",
                                         "q_2",
                                         "v_0",
                                         "v_1",
                                         "v_2",
                                         "input_0",
                                         "input_1",
                                         "input_2"};
// What a function may have of its own, besides its results.
constexpr const char* own[] = {"scratch",      "status",         "stages",
                               "run",          "run_batch",      "results",
                               "inverse",      "factor",         "pivots",
                               "diagonal",     "padded_inverse", "efforts_dq",
                               "efforts_dv",   "mass",           "unscaled_factor",
                               "solve",        "batch",          "batch_tasks",
                               "batch_blocks", "batch_results",  "check_batch",
                               "gain",         "joint",          "constrained_accelerations",
                               "forces",       "response",       "projected_inverse",
                               "row_wrenches", "joint_axes",     "diagonal_apart"};
// What one with sections behind the first (ir/algorithm.hpp) has besides.
constexpr const char* of_derivatives[] = {"accelerations",          "derivatives",
                                          "derivatives_scratch",    "derivatives_stages",
                                          "derivatives_efforts_dq", "derivatives_efforts_dv"};
constexpr const char* of_constrained_derivatives[] = {"constrained_derivatives",
                                                      "constrained_derivatives_scratch",
                                                      "constrained_derivatives_stages",
                                                      "constrained_derivatives_efforts_dq",
                                                      "constrained_derivatives_efforts_dv",
                                                      "constrained_derivatives_changes_dq",
                                                      "constrained_derivatives_changes_dv",
                                                      "constrained_derivatives_turning",
                                                      "constrained_derivatives_turned",
                                                      "constrained_derivatives_turning_room"};

// What one has besides where loops are embedded.
constexpr const char* of_linkages[] = {
    "linkage_status",      "followers", "follower_rates", "speeds_of_all_joints", "accelerations_of_all_joints",
    "forces_of_all_joints"};

// What the code has of a function besides its results.
std::vector<std::string> names_of(const ir::EmittedFunction& function) {
  std::vector<std::string> names{function.name, function.type + "Scratch", function.type + "TaskGraph",
                                 "batch_" + function.name, "rollout_" + function.name};
  for (const char* type : {"BatchResults", "BatchBlock", "BatchProgram", "ImplicitProgram", "ContactProgram"})
    names.push_back(function.type + type);
  for (const char* word : {"_batch", "_batch_tasks", "_batch_blocks", "_batch_results", "_rollout", "_rollout_tasks"})
    names.push_back(function.name + word);
  for (const char* word : own) names.push_back(function.own_name(word));
  for (const std::string& status : ir::kernel_statuses()) names.push_back(function.own_name(status));
  const auto may_compute = [&](ir::Quantity quantity) {
    return function.named ? function.computes(quantity) : function.inputs == ir::Function::forward_dynamics;
  };
  if (may_compute(ir::Quantity::forward_dynamics_dq)) {
    names.push_back(function.type + "DerivativesScratch");
    for (const char* word : of_derivatives) names.push_back(function.own_name(word));
  }
  const ir::Quantity constrained[] = {ir::Quantity::constrained_forward_dynamics_dq,
                                      ir::Quantity::constrained_forward_dynamics_dv, ir::Quantity::constraint_forces_dq,
                                      ir::Quantity::constraint_forces_dv};
  if (std::any_of(std::begin(constrained), std::end(constrained), may_compute)) {
    names.push_back(function.type + "ConstrainedDerivativesScratch");
    for (const char* word : of_constrained_derivatives) names.push_back(function.own_name(word));
  }
  return names;
}

// What it has of one result: as itself, for C, and in the self-test's tables.
void add_names_of_result(const std::string& result, std::vector<std::string>& names) {
  names.push_back(result);
  if (ir::c_accessor(result) != result) names.push_back(ir::c_accessor(result));
  for (const char* word : {"_packed", "_packed_size", "_of_batch", "_bodies", "_joints"}) names.push_back(result + word);
  for (const int state : {0, 1, 2})
    for (const char* table : {"{}_{}", "{}_rows_{}", "{}_{}_columns", "{}_rows_{}_columns", "{}_implicit_{}"})
      names.push_back(fmt::format(fmt::runtime(table), result, state));
}

// Of every folder, whatever its scene.
std::set<std::string> names_of_every_folder() {
  std::vector<std::string> names(std::begin(of_the_folder), std::end(of_the_folder));
  for (const ir::QuantityRow& row : ir::quantities()) add_names_of_result(row.name, names);
  for (const ir::FunctionRow& row : ir::functions)
    for (std::string& name : names_of(ir::standard_function(row.function))) names.push_back(std::move(name));
  return {names.begin(), names.end()};
}

}  // namespace

std::string fault_of_function_name(const std::string& name) {
  if (name != ir::identifier(name) || name.front() == '_' || name.back() == '_' || name.find("__") != name.npos)
    return fmt::format("'{}' cannot be the name of a function", name);
  if (ir::is_cpp_keyword(name)) return fmt::format("'{}' is a keyword of C++", name);
  if (ir::is_macro_of_the_code(name)) return fmt::format("'{}' could be a macro of the generated code", name);
  if (name.starts_with("q_index_") || name.starts_with("v_index_"))
    return fmt::format("'{}' could be a joint's place in the generated code", name);
  if (ir::is_library_macro(name)) return fmt::format("'{}' is a name of the C++ library", name);
  return "";
}

std::vector<TakenName> taken_names(const ir::Scene& scene) {
  if (scene.functions.empty()) return {};
  static const std::set<std::string> of_every_folder = names_of_every_folder();
  std::set<std::string> taken;  // by this scene
  for (const ir::RunTimeInput& input : ir::run_time_inputs(scene))
    for (const char* setter : {"", "set_", "weigh_"}) taken.insert(setter + input.name);
  if (!scene.embedded.empty()) {
    for (const char* name : {"close_loops", "of_all_joints", "independent_runs", "followers"}) taken.insert(name);
    for (size_t i = 0; i < scene.embedded.size(); ++i)  // linkages are no more
      taken.insert("Linkage" + std::to_string(i));
    for (const char* function : {"", "inverse_dynamics_", "forward_dynamics_"})
      for (const char* member : of_linkages) taken.insert(std::string(function) + member);
  }
  std::vector<std::string> of_links;
  for (const ir::LinkOutput& output : scene.link_outputs()) add_names_of_result(ir::name_of(output), of_links);
  taken.insert(of_links.begin(), of_links.end());
  std::vector<TakenName> faults;
  for (const ir::NamedFunction& f : scene.functions) {
    const ir::EmittedFunction function = ir::named_function(f.name, f.quantities, f.of_links);
    std::vector<std::string> names = names_of(function);
    if (!scene.embedded.empty())
      for (const char* member : of_linkages) names.push_back(function.own_name(member));
    for (const ir::Quantity quantity : function.quantities) add_names_of_result(function.result(quantity), names);
    for (const ir::LinkOutput& output : function.of_links) add_names_of_result(function.result(output), names);
    const auto clash = std::find_if(names.begin(), names.end(), [&](const std::string& name) {
      return of_every_folder.contains(name) || taken.contains(name);
    });
    if (clash != names.end()) faults.push_back({f.name, *clash});
    taken.insert(names.begin(), names.end());
  }
  return faults;
}

}  // namespace dalembert::frontend
