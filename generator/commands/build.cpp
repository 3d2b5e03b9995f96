#include "commands/build.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <string_view>
#include <thread>

#include "commands/build/batches.hpp"
#include "commands/build/key.hpp"
#include "commands/build/library.hpp"
#include "commands/build/robot_json.hpp"
#include "commands/build/table_source.hpp"
#include "commands/cache.hpp"
#include "compile.hpp"

namespace dalembert {

namespace {

namespace fs = std::filesystem;

constexpr const char* one_state_test = "one_state_test.cpp";  // beside generated code while it is compiled

const backend::OutputFile* find(const std::vector<backend::OutputFile>& files, std::string_view name) {
  const auto at = std::find_if(files.begin(), files.end(), [&](const backend::OutputFile& f) { return f.name == name; });
  return at == files.end() ? nullptr : &*at;
}

// A part's files: with batches where these are worth their time. Its self-test without them goes to `self_test`.
void generate_part(const Library& library, size_t p, bool batches, std::vector<backend::OutputFile>& files,
                   std::string& self_test, std::vector<std::string>& batched) {
  constexpr size_t longest = 1'500'000;  // of a batch.cpp, which takes compilers some 10 s
  Model model = library.parts[p].model;
  const bool for_controller = model.scene.batch;
  model.scene.batch = false;
  files = compile(model);
  self_test = find(files, "self_test.cpp")->text;
  if (!batches && !for_controller) return;
  model.scene.batch = true;
  std::vector<std::string> found = functions_in_lanes(model, lower(model));
  if (found.empty() && !for_controller) return;
  std::vector<backend::OutputFile> with = compile(model);
  const bool worth = batches && find(with, "batch.cpp")->text.size() <= longest;
  if (worth || for_controller) files = std::move(with);
  if (worth) batched = std::move(found);
}

// The units of code.so. Files of few lines are mostly headers: together they are as many files as there are cores.
std::vector<Unit> units_of(const Library& library, const std::vector<std::string>& self_tests, const fs::path& folder) {
  constexpr size_t long_enough = 150'000;
  struct File {
    std::string include;
    size_t size;
  };
  std::vector<File> files;
  size_t all = 0;
  std::string tests;
  for (size_t p = 0; p < library.parts.size(); ++p) {
    const Part& part = library.parts[p];
    for (const backend::OutputFile& file : part.files) {
      if (!file.name.ends_with(".cpp")) continue;
      if (file.name == "c_api.cpp" || file.name == "self_test.cpp" || file.name == "batch.cpp") continue;
      files.push_back({fmt::format("#include \"{}/{}\"\n", part.model.name, file.name), file.text.size()});
      all += file.text.size();
    }
    const std::string test = part.model.name + "/" + one_state_test;
    write_text(folder / "source" / test, self_tests[p]);
    tests += fmt::format("#include \"{}\"\n", test);
  }
  std::sort(files.begin(), files.end(), [](const File& a, const File& b) { return a.size > b.size; });
  std::vector<File> groups(std::min(files.size(), std::max<size_t>({1, std::thread::hardware_concurrency(), all / long_enough})));
  for (const File& file : files) {
    File& least = *std::min_element(groups.begin(), groups.end(), [](const File& a, const File& b) { return a.size < b.size; });
    least.include += file.include;
    least.size += file.size;
  }
  std::vector<Unit> units;
  for (const File& group : groups) {
    units.push_back({folder / "objects" / fmt::format("code_{}.cpp", units.size()), true});
    write_text(units.back().source, group.include);
  }
  units.push_back({folder / "objects" / "self_tests.cpp", false});
  write_text(units.back().source, tests);
  units.push_back({folder / "objects" / "function_table.cpp", true});
  write_text(units.back().source, table_source(library));
  return units;
}

bool wants_batches(const Request& request) {
  return std::none_of(request.settings.begin(), request.settings.end(),
                      [](const frontend::Setting& s) { return s.key == "batch" && s.text == "false"; });
}

void make(const Request& request, const CompilerOptions& options, Diagnostics& warnings, const fs::path& folder) {
  const Model model = read_model(request, warnings);
  Library library = library_of(model, warnings);
  const size_t count = library.parts.size();
  std::vector<std::string> self_tests(count);
  std::vector<std::vector<std::string>> batched(count);
  const bool batches = wants_batches(request);
  in_parallel(count, [&](size_t p) {
    Part& part = library.parts[p];
    generate_part(library, p, batches, part.files, self_tests[p], batched[p]);
    backend::write_files((folder / "source" / part.model.name).string(), part.files);
  });
  find_what_is_read(library);
  for (size_t p = 0; p < count; ++p) {
    std::vector<size_t> functions;
    for (size_t f = 0; f < library.functions.size(); ++f) {
      TableFunction& function = library.functions[f];
      if (function.part != p ||
          std::find(batched[p].begin(), batched[p].end(), function.function.name) == batched[p].end())
        continue;
      function.batch_entry = static_cast<int>(functions.size());
      functions.push_back(f);
    }
    if (!functions.empty())
      write_text(folder / "source" / batches_table_file(p), batch_table_source(library, functions));
  }
  write_compiler(folder, compiler_and_flags(options));

  const fs::path objects = folder / "objects", code = folder / "code.so";
  fs::create_directory(objects);
  compile_units(units_of(library, self_tests, folder), {compiler_and_flags(options), folder / "source"}, objects, code);
  std::error_code ignored;
  fs::remove_all(objects, ignored);
  for (const Part& part : library.parts) fs::remove(folder / "source" / part.model.name / one_state_test, ignored);
  run_self_tests(code);
  write_text(folder / entry_file, robot_json(library, request, options, fs::file_size(code), warnings));
}

}  // namespace

std::string build(const Request& request, const CompilerOptions& options, Diagnostics& warnings) {
  return cached(key_of(request, options), [&](const fs::path& folder) { make(request, options, warnings, folder); }).string();
}

std::string command_line_of(const fs::path& entry) {
  std::ifstream file(entry / entry_file);
  constexpr std::string_view key = "  \"command_line\": ";
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(key)) return line.substr(key.size() + 1, line.size() - key.size() - 3);
  return "";
}

}  // namespace dalembert
