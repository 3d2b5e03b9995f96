#include "commands/build.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <numeric>
#include <string_view>

#include "backend/code_name.hpp"
#include "commands/build/batches.hpp"
#include "commands/build/key.hpp"
#include "commands/build/library.hpp"
#include "commands/build/robot_json.hpp"
#include "commands/build/table_source.hpp"
#include "commands/cache.hpp"
#include "commands/json.hpp"
#include "commands/parallel.hpp"
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
void generate_part(const Library& library, size_t p, std::vector<backend::OutputFile>& files, std::string& self_test,
                   std::vector<std::string>& batched) {
  constexpr size_t longest = 1'500'000;  // of a batch.cpp, which takes compilers some 10 s
  Model model = library.parts[p].model;
  const bool for_controller = model.scene.batch;
  model.scene.batch = false;
  files = compile(model);
  self_test = find(files, "self_test.cpp")->text;
  model.scene.batch = true;
  std::vector<std::string> found = functions_in_lanes(model, lower(model));
  if (found.empty() && !for_controller) return;
  std::vector<backend::OutputFile> with = compile(model);
  const bool worth = find(with, "batch.cpp")->text.size() <= longest;
  if (worth || for_controller) files = std::move(with);
  self_test = backend::named_as(self_test, find(files, "dynamics.hpp")->text);
  if (worth) batched = std::move(found);
}

// Whether it is lines of operations alone: no function of the runtime in it is inlined here and called there.
bool is_straight(const std::string& text) {
  constexpr std::string_view include = "#include <dalembert/", of_lines[] = {"sincos.", "straight_line.", "narrow_packing."};
  for (size_t at = 0; (at = text.find(include, at)) != text.npos;) {
    const std::string_view file = std::string_view(text).substr(at += include.size());
    if (std::none_of(std::begin(of_lines), std::end(of_lines), [&](std::string_view name) { return file.starts_with(name); }))
      return false;
  }
  return true;
}

// The units of code.so: each file of the parts is one, as users compile them, since what else a compiler sees may decide how it
// rounds. But straight lines and short files are mostly headers: of these there are as many as there are cores, or one.
std::vector<Unit> units_of(const Library& library, const std::vector<std::string>& self_tests, const fs::path& folder) {
  constexpr size_t long_enough = 15'000;
  struct File {
    std::string include;
    size_t size;
    bool alone = false;
  };
  std::vector<File> files{{table_source(library), 10'000}};
  std::string tests;
  for (size_t p = 0; p < library.parts.size(); ++p) {
    const Part& part = library.parts[p];
    for (const backend::OutputFile& file : part.files) {
      if (!file.name.ends_with(".cpp")) continue;
      if (file.name == "c_api.cpp" || file.name == "self_test.cpp" || file.name == "batch.cpp") continue;
      files.push_back({fmt::format("#include \"{}/{}\"\n", part.model.name, file.name), file.text.size(),
                       file.text.size() >= long_enough && !is_straight(file.text)});
    }
    const std::string test = part.model.name + "/" + one_state_test;
    write_text(folder / "source" / test, self_tests[p]);
    tests += fmt::format("#include \"{}\"\n", test);
  }
  std::stable_sort(files.begin(), files.end(), [](const File& a, const File& b) { return a.size > b.size; });
  const auto own = std::stable_partition(files.begin(), files.end(), [](const File& file) { return file.alone; });
  std::vector<File> groups(files.begin(), own);
  const size_t begin = groups.size(), others = static_cast<size_t>(files.end() - own);
  const size_t all = std::accumulate(own, files.end(), size_t{0}, [](size_t sum, const File& file) { return sum + file.size; });
  const size_t cores = usable_cores();
  groups.resize(begin + (all < long_enough ? 1 : std::min(others, std::max(cores, all / 150'000))));
  for (auto file = own; file != files.end(); ++file) {
    File& least = *std::min_element(groups.begin() + static_cast<std::ptrdiff_t>(begin), groups.end(),
                                    [](const File& a, const File& b) { return a.size < b.size; });
    least.include += file->include;
    least.size += file->size;
  }
  std::vector<Unit> units;
  for (const File& group : groups) {
    units.push_back({folder / "objects" / fmt::format("code_{}.cpp", units.size()), true});
    write_text(units.back().source, group.include);
  }
  units.push_back({folder / "objects" / "self_tests.cpp", false});
  write_text(units.back().source, tests);
  return units;
}

void make(const Request& request, const CompilerOptions& options, Diagnostics& warnings, const fs::path& folder) {
  const Model model = read_model(request, warnings);
  Library library = library_of(model, warnings);
  const size_t count = library.parts.size();
  std::vector<std::string> self_tests(count);
  std::vector<std::vector<std::string>> batched(count);
  each_in_parallel(count, [&](size_t p) {
    Part& part = library.parts[p];
    generate_part(library, p, part.files, self_tests[p], batched[p]);
    backend::write_files((folder / "source" / part.model.name).string(), part.files);
  });
  find_what_is_read(library);
  for (size_t p = 0; p < count; ++p) {
    std::vector<size_t> functions;
    for (size_t f = 0; f < library.functions.size(); ++f) {
      TableFunction& function = library.functions[f];
      if (function.part != p || std::find(batched[p].begin(), batched[p].end(), function.function.name) == batched[p].end())
        continue;
      function.batch_entry = static_cast<int>(functions.size());
      functions.push_back(f);
    }
    if (!functions.empty()) write_text(folder / "source" / batches_table_file(p), batch_table_source(library, functions));
  }
  write_compiler(folder, compiler_and_flags(options));

  const fs::path objects = folder / "objects", code = folder / "code.so";
  fs::create_directory(objects);
  keep_temporary_files_in(objects);
  // By the entry's key: the loader takes libraries of one name for one.
  const std::string soname = fmt::format("-Wl,-soname,dalembert.{}.so", folder.filename().string().substr(0, 32));
  compile_units(units_of(library, self_tests, folder), {compiler_and_flags(options), folder / "source", {soname}}, objects,
                code);
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
    if (line.starts_with(key))
      return text_of_json_string(std::string_view(line).substr(key.size(), line.size() - key.size() - 1));
  return "";
}

}  // namespace dalembert
