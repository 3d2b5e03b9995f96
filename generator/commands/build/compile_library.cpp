#include "commands/build/compile_library.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <stdlib.h>

#include <dalembert/function_table.hpp>
#include <fstream>

#include "commands/parallel.hpp"
#include "diagnostics.hpp"

namespace dalembert {

namespace fs = std::filesystem;

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream)
    throw InputError({Severity::error, file.string(), "cache", "the file cannot be written",
                      "look for a full disk, or set XDG_CACHE_HOME to a folder with room"});
}

void keep_temporary_files_in(const fs::path& folder) { setenv("TMPDIR", folder.c_str(), 1); }

void compile_units(const std::vector<Unit>& units, const Compiling& how, const fs::path& objects, const fs::path& object) {
  const auto compile = [&](size_t i) {
    std::vector<std::string> command = how.compiler_and_flags;
    if (!units[i].for_speed) command.push_back("-O0");
    command.insert(command.end(), {"-fPIC", "-I" + how.sources.string()});
    for (const std::string& word : include_words()) command.push_back(word);
    command.insert(command.end(), {"-c", units[i].source.string(), "-o", (objects / fmt::format("{}.o", i)).string()});
    run_compiler(command, objects / fmt::format("{}.log", i));
  };
  each_in_parallel(units.size(), compile);
  std::vector<std::string> link = how.compiler_and_flags;
  link.push_back("-shared");
  for (size_t i = 0; i < units.size(); ++i) link.push_back((objects / fmt::format("{}.o", i)).string());
  link.insert(link.end(), {"-o", object.string()});
  link.insert(link.end(), how.libraries.begin(), how.libraries.end());
  run_compiler(link, objects / "link.log");
}

SharedObject::SharedObject(const fs::path& file) : handle_(dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL)) {
  if (!handle_) throw std::runtime_error(std::string("the compiled code cannot be loaded: ") + dlerror());
}

SharedObject::~SharedObject() { dlclose(handle_); }

void* SharedObject::symbol(const char* name) const { return dlsym(handle_, name); }

void run_self_tests(const fs::path& file) {
  const SharedObject object(file);
  const auto table_of = reinterpret_cast<const FunctionTable* (*)()>(object.symbol("dalembert_function_table"));
  const FunctionTable& table = *table_of();
  for (int i = 0; i < table.functions; ++i) {
    SelfTestReport report;
    if (table.entries[i].self_test(&report)) continue;
    char text[512];
    describe(report, text, sizeof text);
    throw SelfTestFailure(std::string("the code does not compute on this machine what it should: ") + text);
  }
}

}  // namespace dalembert
