#include "commands/generate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "backend/output_files.hpp"
#include "frontend/robot_file.hpp"

namespace dalembert {

namespace {

std::string written(const Model& model, const std::vector<backend::OutputFile>& files, const std::string& folder) {
  size_t bytes = 0;
  for (const backend::OutputFile& file : files) bytes += file.text.size();
  return fmt::format("{}: {} files, {} kB, in {}\n", model.name, files.size(), (bytes + 999) / 1000, folder);
}

// The banner of a generated file: its first lines of comment.
std::string banner_of(const std::string& text) {
  size_t end = 0;
  while (text.compare(end, 2, "//") == 0) end = text.find('\n', end) + 1;
  return text.substr(0, end);
}

}  // namespace

std::string generate(const Model& model, const std::string& folder) {
  backend::check_folder(folder);  // before minutes of work
  const std::vector<backend::OutputFile> files = compile(model);
  backend::write_files(folder, files);
  return written(model, files, folder);
}

std::string generate_c(const Model& whole, const std::string& folder) {
  const std::filesystem::path code = std::filesystem::path(folder) / "code";
  backend::check_folder(code.string());
  Model model = whole;
  model.scene.parallel = ir::Parallel::serial;  // which needs no library but Eigen
  model.command_line += " --language c";
  std::vector<backend::OutputFile> files = compile(model);
  const auto c_api = std::find_if(files.begin(), files.end(), [](const auto& file) { return file.name == "c_api.h"; });
  backend::OutputFile header{model.name + ".h", c_api->text};
  const std::string banner = banner_of(c_api->text);
  const size_t at = header.text.find("#ifndef");
  header.text.insert(
      at == header.text.npos ? banner.size() : at,
      "// This header is all that is promised. The code behind it stands in code/ and is C++17: compile the files there with\n"
      "// Eigen's and dalembert's headers, where there are neither exceptions nor run-time types, too, and link with the C++\n"
      "// library, whose `new` create() calls and nothing else.\n");
  c_api->text = banner + fmt::format("#include \"../{}.h\"\n", model.name);
  for (backend::OutputFile& file : files) file.name = "code/" + file.name;
  files.push_back(std::move(header));
  backend::write_files(folder, files);
  return written(model, files, folder);
}

namespace {

constexpr std::string_view depfile_ending = ".d";

[[noreturn]] void refuse_depfile(const std::string& what, const char* remedy) {
  throw InputError({Severity::error, "", "option --depfile", what, remedy});
}

// As make and ninja read it.
std::string in_rule(const std::string& path) {
  std::string text;
  for (const char c : path) {
    if (c == ' ' || c == '#') text += '\\';
    if (c == '$') text += '$';
    text += c;
  }
  return text;
}

}  // namespace

void check_depfile(const std::string& file) {
  const std::filesystem::path path = file;
  if (!file.ends_with(depfile_ending) || path.stem() == depfile_ending)
    refuse_depfile(fmt::format("'{}' is no name that ends in .d", file), "call it what it is a rule for, and .d");
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) refuse_depfile(fmt::format("{} is a folder", file), "name a file");
}

void write_depfile(const std::string& file, const Model& model, const std::string& scene_file) {
  namespace fs = std::filesystem;
  std::vector<std::string> sources = frontend::files_of(model.description);
  if (!scene_file.empty()) sources.push_back(fs::absolute(scene_file).lexically_normal().string());
  std::string text =
      in_rule(fs::absolute(file.substr(0, file.size() - depfile_ending.size())).lexically_normal().string()) + ":";
  for (const std::string& source : sources) text += " \\\n  " + in_rule(source);
  const bool is_device = backend::is_no_file(file);
  const std::string making = is_device ? file : file + ".part";
  std::ofstream stream(making, std::ios::binary);
  stream << text << '\n' << std::flush;
  std::error_code error;
  if (stream && !is_device) fs::rename(making, file, error);
  if (stream && !error) return;
  if (!is_device) fs::remove(making, error);
  refuse_depfile(fmt::format("{} cannot be written", file), "name a file in a folder that is there and can be written");
}

}  // namespace dalembert
