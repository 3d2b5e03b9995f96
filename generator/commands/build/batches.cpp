#include "commands/build/batches.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <sstream>
#include <utility>

#include "commands/build.hpp"
#include "commands/build/compile_library.hpp"
#include "commands/build/key.hpp"
#include "commands/cache.hpp"
#include "commands/parallel.hpp"
#include "diagnostics.hpp"

namespace dalembert {

namespace {

namespace fs = std::filesystem;

constexpr const char* compiler_file = "source/compiler";

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// The part's name, as its table includes it: #include "NAME/batch.hpp".
std::string name_in(const std::string& table) {
  const size_t begin = table.find("#include \""), end = table.find("/batch.hpp\"");
  return begin == table.npos || end == table.npos ? "" : table.substr(begin + 10, end - begin - 10);
}

void make_batches(const fs::path& entry, const std::vector<std::string>& command, size_t part, const fs::path& folder) {
  const fs::path table = entry / "source" / batches_table_file(part), object = folder / fmt::format("{}.so", part),
                 objects = folder / std::to_string(part);
  const std::string name = name_in(text_of(table));
  if (name.empty())
    throw InputError(
        {Severity::error, entry.string(), fmt::format("part {}", part), "it has no batches", "load the robot again"});
  fs::create_directory(objects);
  std::string code = fmt::format("#include \"{}/batch.cpp\"\n#include \"{}\"\n", name, table.filename().string());
  const std::string test = fmt::format("#include \"{}/self_test.cpp\"\n", name);
  std::vector<Unit> units{{objects / "batch.cpp", true}};
  // Of a short one the headers are most: the self-test, which need not be fast, is compiled with it.
  constexpr std::uintmax_t short_enough = 40'000;
  if (fs::file_size(entry / "source" / name / "batch.cpp") < short_enough) {
    code += test;
  } else {
    units.push_back({objects / "self_test.cpp", false});
    write_text(units.back().source, test);
  }
  write_text(units.front().source, code);
  // The functions themselves, which tell what is wrong near a singular M, are those of the entry's code.so: whoever loads this
  // has that loaded, and it is known by a name of its own. What both have is taken from here.
  compile_units(units, {command, entry / "source", {"-Wl,-Bsymbolic", "-L" + entry.string(), "-l:code.so"}}, objects, object);
  std::error_code ignored;
  fs::remove_all(objects, ignored);
}

}  // namespace

std::string batches_table_file(size_t part) { return fmt::format("batches_{}.cpp", part); }

void write_compiler(const fs::path& entry, const std::vector<std::string>& compiler_and_flags) {
  std::string text = generator_id() + "\n";
  for (const std::string& word : compiler_and_flags) text += word + "\n";
  write_text(entry / compiler_file, text);
}

void build_batches(const fs::path& entry, const std::vector<size_t>& parts) {
  const auto refuse = [&](const char* what) {
    throw InputError({Severity::error, entry.string(), "cache", what, "load the robot again"});
  };
  std::istringstream lines(text_of(entry / compiler_file));
  std::vector<std::string> command;
  for (std::string line; std::getline(lines, line);) command.push_back(line);
  if (command.size() < 2) refuse("there is no such entry");
  if (command.front() != generator_id()) refuse("it was made by another generator");
  command.erase(command.begin());
  std::vector<std::string> markers;
  for (const size_t part : parts) markers.push_back(fmt::format("batches_{}.json", part));
  add_to_entry(entry, markers, [&](const std::vector<size_t>& missing, const fs::path& folder) {
    Made files;
    keep_temporary_files_in(folder);
    each_in_parallel(missing.size(), [&](size_t i) { make_batches(entry, command, parts[missing[i]], folder); });
    const SharedObject code(entry / "code.so");
    for (const size_t i : missing) run_self_tests(folder / fmt::format("{}.so", parts[i]));
    for (const size_t i : missing) {
      const fs::path object = folder / fmt::format("{}.so", parts[i]), marker = folder / markers[i];
      const std::string name = fmt::format("batches_{}.so", parts[i]);
      write_text(marker, fmt::format("{{\"code_bytes\": {}}}\n", fs::file_size(object)));
      files.emplace_back(object, name);
      files.emplace_back(marker, markers[i]);
    }
    return files;
  });
}

}  // namespace dalembert
