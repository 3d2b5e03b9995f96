#include "pipeline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "frontend/robot_file.hpp"
#include "frontend/scene_check.hpp"
#include "idle_keys.hpp"
#include "ir/emitted_function.hpp"
#include "ir/identifier.hpp"
#include "ir/library_names.hpp"
#include "ir/plan_words.hpp"
#include "passes/build_tree.hpp"
#include "passes/inertia_check.hpp"
#include "passes/joints_without_mass.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/resolve_parts.hpp"
#include "reference/solvable.hpp"

namespace dalembert {

namespace {

// Why the name cannot be the namespace of the generated code; empty when it can.
std::string fault_of(const std::string& name) {
  if (name != ir::identifier(name)) return fmt::format("'{}' cannot be the name of a C++ namespace", name);
  if (ir::is_cpp_keyword(name)) return fmt::format("'{}' is a keyword of C++", name);
  if (ir::is_library_macro(name) || ir::is_library_name(name)) return fmt::format("'{}' is a name of the C++ library", name);
  if (ir::is_macro_of_the_code(name)) return fmt::format("'{}' could be a macro of the generated code", name);
  // The last ones by their C functions: pthread_create, sem_destroy.
  for (const char* taken : {"dalembert", "std", "Eigen", "tbb", "main", "pthread", "timer", "thrd", "tss", "sem", "mtx", "cnd"})
    if (name == taken) return fmt::format("'{}' is the name of a library the generated code uses", name);
  return "";
}

// The namespace of the generated code: what the user says, or what the robot is called.
std::string code_name(const Request& request, const ir::RobotDescription& robot, Diagnostics& warnings) {
  if (!request.name.empty()) {
    if (const std::string fault = fault_of(request.name); !fault.empty())
      throw InputError({Severity::error, "", "option --name", fault,
                        "give another with --name: letters, digits and '_', not starting with a digit"});
    return request.name;
  }
  const std::string name = ir::identifier(robot.name);
  const std::string fault = fault_of(name);
  if (fault.empty()) return name;
  warnings.push_back({Severity::warning, robot.file, fmt::format("robot '{}'", robot.name), fault,
                      fmt::format("its namespace is '{}_'; give another with --name", name)});
  return name + "_";
}

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

// As one word of a shell's command line.
std::string quoted(const std::string& text) {
  const bool plain = !text.empty() && text.find_first_not_of(
                                          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                          "_-+=.,:/") == text.npos;
  if (plain) return text;
  std::string word = "'";
  for (char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

std::string command_line(const Request& request, const std::string& name) {
  std::string line = "dalembert generate " + quoted(file_name(request.robot));
  if (!request.scene_file.empty()) line += " --scene " + quoted(file_name(request.scene_file));
  for (const std::string& key : frontend::scene_keys())
    for (const frontend::Setting& setting : request.settings)
      if (setting.key == key) line += fmt::format(" --{} {}", key, quoted(setting.text));
  if (!request.form.empty()) line += " --form " + request.form;
  for (const std::string& pass : request.without) line += " --without " + pass;
  if (request.costs) line += " --calibrated";
  return line + " --name " + name;
}

// The command line's parser has checked the words.
ir::CompileOptions compile_options(const Request& request) {
  ir::CompileOptions options;
  options.costs = request.costs;
  if (request.form == "straight") options.form = ir::Form::straight;
  if (request.form == "rolled") options.form = ir::Form::rolled;
  for (const std::string& pass : request.without) {
    if (pass == "fold") options.fold = false;
    if (pass == "share") options.share = false;
    if (pass == "move_parameters") options.move_parameters = false;
    if (pass == "refer") options.refer = false;
    if (pass == "pack") options.pack = false;
    if (pass == "join") options.join = false;
    if (pass == "weigh") options.weigh = false;
    if (pass == "write_limbs") options.write_limbs = false;
  }
  return options;
}

void check_size(const ir::RobotDescription& robot, const ir::KinematicTree& tree) {
  if (tree.joints() > most_moving_joints)
    throw InputError({Severity::error, robot.file, fmt::format("robot '{}'", robot.name),
                      fmt::format("{} joints move; no more than {} are supported", tree.joints(), most_moving_joints),
                      "make joints fixed, or lock or cut them in the scene"});
}

// What a plan asks for is there to be chosen.
void check_plan(const ir::KinematicTree& tree, const ir::Scene& scene) {
  const auto refuse = [](const std::string& message, const char* remedy) {
    throw InputError({Severity::error, "", "scene key 'plan'", message, remedy});
  };
  for (const ir::EmittedFunction& function : ir::functions_of(scene)) {
    const auto how = scene.plan.find(function.name);
    if (how == scene.plan.end()) continue;
    const std::vector<ir::Solver> solvers = passes::solvers(function, tree, scene);
    if (how->second.solver && std::find(solvers.begin(), solvers.end(), *how->second.solver) == solvers.end())
      refuse(fmt::format("the function '{}' cannot be computed by {} here", function.name,
                         word_of(ir::solver_words(), *how->second.solver)),
             "leave the solver out, or measure again with --plan measure");
    if (how->second.form == ir::Form::rolled && tree.bodies.empty())
      refuse(fmt::format("'{}' cannot be rolled: no joint of the robot moves", function.name), "leave its form out");
  }
}

// Loops run over limbs.
void check_form(const ir::RobotDescription& robot, const ir::KinematicTree& tree, const ir::CompileOptions& options) {
  if (options.form == ir::Form::rolled && tree.bodies.empty())
    throw InputError(
        {Severity::error, robot.file, "option --form",
         fmt::format("robot '{}' has no joint that moves, and the rolled form's loops run over joints", robot.name),
         "leave the option out, or ask for straight"});
}

}  // namespace

Model read_model(const Request& request, Diagnostics& warnings) {
  const frontend::SceneDocument document = frontend::read_scene(request.scene_file, request.settings);
  Model model;
  model.description = frontend::read_robot(request.robot, warnings);
  model.name = code_name(request, model.description, warnings);
  model.options = compile_options(request);
  model.command_line = command_line(request, model.name);
  apply_scene(model, document, warnings);
  check_size(model.description, model.tree);
  if (!request.for_one_output) {
    passes::check_mass(model.description, model.tree, model.scene);
    reference::check_solvable(model.description, model.tree, model.scene, warnings);
    warn_of_idle_keys(model.scene, model.tree, warnings);
  }
  check_form(model.description, model.tree, model.options);
  check_plan(model.tree, model.scene);
  return model;
}

void apply_scene(Model& model, const frontend::SceneDocument& document, Diagnostics& warnings) {
  model.scene = frontend::check_scene(document, model.description, warnings);
  model.tree = passes::build_tree(model.description, model.scene, warnings);
  if (model.scene.lock_massless) {
    model.scene = passes::with_massless_locked(model.description, model.tree, model.scene, warnings);
    Diagnostics same_again;
    model.tree = passes::build_tree(model.description, model.scene, same_again);
  }
  passes::resolve_parts(model.scene, model.tree);
  passes::check_inertias(model.description, model.scene, model.tree, warnings);
}

}  // namespace dalembert
