#include "commands/package.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "backend/templates.hpp"
#include "commands/compiler.hpp"
#include "commands/labels.hpp"
#include "commands/output.hpp"
#include "compile.hpp"
#include "diagnostics.hpp"

namespace dalembert {

namespace {

namespace fs = std::filesystem;

// The runtime's headers, by the folder they stand in.
std::map<std::string, std::vector<backend::OutputFile>> runtime_headers() {
  std::map<std::string, std::vector<backend::OutputFile>> folders;
  for (const fs::path from : include_folders()) {
    std::error_code error;
    if (!fs::exists(from / "dalembert" / "version.hpp", error)) continue;
    for (const fs::directory_entry& at : fs::recursive_directory_iterator(from / "dalembert")) {
      if (at.path().extension() != ".hpp") continue;
      std::ifstream file(at.path(), std::ios::binary);
      const fs::path name = at.path().lexically_relative(from);
      folders[name.parent_path().string()].push_back(
          {name.filename().string(),
           fmt::format("// {}: a header of its runtime, as it is (BSD-3-Clause).\n", backend::banner_mark) +
               std::string(std::istreambuf_iterator<char>(file), {})});
    }
    return folders;
  }
  throw InputError({Severity::error, "", "option --package", "the runtime's headers are not found",
                    "name the folder that has dalembert/version.hpp with DALEMBERT_INCLUDE"});
}

std::string shape(int rows, int columns) { return columns == 1 ? std::to_string(rows) : fmt::format("{} × {}", rows, columns); }

// A row per result of each function.
std::string results_table(const Model& model) {
  std::string text = "| function | result | shape | unit | |\n|---|---|---|---|---|\n";
  for (const Output& output : outputs_of(model)) {
    const std::string more = output.function.input();
    const std::string call = fmt::format("`{}(q, v{}, workspace)`", output.function.name, more.empty() ? "" : ", " + more);
    const Words words = words_of(output);
    text += fmt::format("| {} | `{}` | {} | {} | {} |\n", call, output.name, shape(output.rows, output.columns), words.unit,
                        words.help);
  }
  return text;
}

std::string coordinates_table(const Model& model) {
  const ir::KinematicTree& tree = model.tree;
  std::string text = "| joint | q | v | |\n|---|---:|---:|---|\n";
  int q = tree.base_positions(), v = tree.base_coordinates();
  if (tree.base_coordinates() > 0)
    text +=
        "| the base | 0–6 | 0–5 | position in the world, quaternion x y z w; linear and angular velocity in the base's axes "
        "|\n";
  for (const ir::Body& body : tree.bodies)
    if (body.has_quaternion()) {
      const ir::JointTypeRow& kind = ir::row_of(body.kind);
      text += fmt::format("| {} | {}–{} | {}–{} | {} |\n", body.of, q, q + kind.nq - 1, v, v + kind.nv - 1, kind.coordinates);
      q += kind.nq, v += kind.nv;
    } else if (body.follows) {
      text += fmt::format("| {} | {} | – | {}, follows by a loop |\n", body.joint, q++, body.turns() ? "rad" : "m");
    } else if (!body.driven() && !body.of_quaternion()) {
      text += fmt::format("| {} | {} | {} | {} |\n", body.joint, q++, v++, body.turns() ? "rad" : "m");
    }
  return text;
}

std::string figures(const Model& model) {
  const Lowered lowered = lower(model);
  std::string text = "| function | multiplications | additions | sines and cosines | divisions |\n|---|---:|---:|---:|---:|\n";
  for (const auto& [function, o] : executed_operations(model, lowered))
    text += fmt::format("| `{}` | {} | {} | {} | {} |\n", function, o.multiply, o.add, o.sincos, o.divide);
  return text +
         fmt::format("\nA workspace has {} bytes. Nothing is allocated, locked or thrown.\n", workspace_bytes(model, lowered));
}

// CMake's own targets, and what stands in a package or beside it.
void check_package_name(const std::string& name) {
  constexpr const char* taken[] = {"all",           "build",          "clean",
                                   "depend",        "edit_cache",     "help",
                                   "include",       "install",        "list_install_components",
                                   "package",       "package_source", "preinstall",
                                   "rebuild_cache", "test",           "Eigen3",
                                   "Testing"};
  if (std::find(std::begin(taken), std::end(taken), name) == std::end(taken)) return;
  throw InputError({Severity::error, "", "option --package",
                    fmt::format("'{}' is what CMake, or a folder of the package, is called", name),
                    "give another name with --name"});
}

}  // namespace

std::string generate_package(const Model& whole, const std::string& folder) {
  check_package_name(whole.name);
  backend::check_folder(folder);
  Model model = whole;
  model.scene.parallel = ir::Parallel::serial;  // which needs no library but Eigen
  const std::map<std::string, std::vector<backend::OutputFile>> headers = runtime_headers();
  const std::vector<backend::OutputFile> code = compile(model);
  const auto filled = [&](const char* as, const char* from, backend::Fields fields) {
    if (std::string_view(as) != "package.xml") fields.emplace("name", model.name);
    fields.emplace("mark", backend::banner_mark);
    return backend::OutputFile{as, backend::render(from, fields)};
  };
  std::string package = model.name;  // of a ROS package: lower-case letters, digits and '_'
  std::transform(package.begin(), package.end(), package.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  std::vector<std::string> sources;
  for (const backend::OutputFile& file : code)
    if (file.name.ends_with(".cpp")) sources.push_back(model.name + "/" + file.name);
  const std::vector<backend::OutputFile> about{
      filled("CMakeLists.txt", "package_CMakeLists.txt",
             {{"dollar", "$"}, {"sources", fmt::format("{}", fmt::join(sources, " "))}}),
      filled("package.xml", "package.xml", {{"package", package}}), filled("self_test_main.cpp", "package_self_test.cpp", {}),
      filled("README.md", "package_README.md",
             {{"command", model.command_line + " --package"},
              {"robot", model.tree.robot},
              {"results", results_table(model)},
              {"coordinates", coordinates_table(model)},
              {"figures", figures(model)}})};
  std::vector<backend::OutputFile> all = about;
  const auto add = [&](const fs::path& place, const std::vector<backend::OutputFile>& files) {
    for (const backend::OutputFile& file : files) all.push_back({(place / file.name).string(), file.text});
  };
  add(model.name, code);
  for (const auto& [place, files] : headers) add(fs::path("include") / place, files);
  backend::write_files(folder, all);
  return fmt::format("{}: a package in {}; build it with cmake, and run its self-test with ctest\n", model.name, folder);
}

}  // namespace dalembert
