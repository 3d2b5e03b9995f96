#include "pipeline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "frontend/scene_check.hpp"
#include "frontend/urdf_reader.hpp"
#include "ir/identifier.hpp"
#include "ir/library_names.hpp"
#include "passes/build_tree.hpp"

namespace dalembert {

namespace {

// The namespace of the generated code.
std::string code_name(const Request& request, const ir::RobotDescription& robot) {
  const std::string name = request.name.empty() ? ir::identifier(robot.name) : request.name;
  const auto refuse = [&](std::string message) {
    const bool given = !request.name.empty();
    throw InputError({Severity::error, given ? "" : robot.file, given ? "option --name" : fmt::format("robot '{}'", robot.name),
                      std::move(message), "give another with --name: letters, digits and '_', not starting with a digit"});
  };
  if (name != ir::identifier(name)) refuse(fmt::format("'{}' cannot be the name of a C++ namespace", name));
  if (ir::is_cpp_keyword(name)) refuse(fmt::format("'{}' is a keyword of C++", name));
  if (ir::is_library_macro(name) || ir::is_library_function(name))
    refuse(fmt::format("'{}' is a name of the C++ library", name));
  // The last ones by their C functions: pthread_create, sem_destroy.
  for (const char* taken : {"dalembert", "std", "Eigen", "tbb", "main", "pthread", "timer", "thrd", "tss", "sem", "mtx", "cnd"})
    if (name == taken) refuse(fmt::format("'{}' is the name of a library the generated code uses", name));
  return name;
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
  return line + " --name " + name;
}

// The command line's parser has checked the words.
ir::CompileOptions compile_options(const Request& request) {
  ir::CompileOptions options;
  if (request.form == "straight") options.form = ir::Form::straight;
  if (request.form == "rolled") options.form = ir::Form::rolled;
  for (const std::string& pass : request.without) {
    if (pass == "fold") options.fold = false;
    if (pass == "share") options.share = false;
    if (pass == "move_parameters") options.move_parameters = false;
    if (pass == "pack") options.pack = false;
  }
  return options;
}

void check_size(const ir::RobotDescription& robot, const ir::KinematicTree& tree) {
  if (tree.joints() > most_moving_joints)
    throw InputError({Severity::error, robot.file, fmt::format("robot '{}'", robot.name),
                      fmt::format("{} joints move; no more than {} are supported", tree.joints(), most_moving_joints),
                      "make joints fixed, or lock or cut them in the scene"});
}

}  // namespace

Model read_model(const Request& request, Diagnostics& warnings) {
  const frontend::SceneDocument document = frontend::read_scene(request.scene_file, request.settings);
  Model model;
  model.description = frontend::read_urdf(request.robot, warnings);
  model.name = code_name(request, model.description);
  model.options = compile_options(request);
  model.command_line = command_line(request, model.name);
  model.scene = frontend::check_scene(document, model.description, warnings);
  model.tree = passes::build_tree(model.description, model.scene, warnings);
  check_size(model.description, model.tree);
  return model;
}

}  // namespace dalembert
