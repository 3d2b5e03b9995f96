#include "commands/compiler.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "commands/temporary_folder.hpp"
#include "diagnostics.hpp"

extern char** environ;

namespace dalembert {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(std::string message, std::string remedy) {
  throw InputError({Severity::error, "", "C++ compiler", std::move(message), std::move(remedy)});
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, separator);)
    if (!word.empty()) words.push_back(word);
  return words;
}

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

// Runs a command with its output in `log`; the exit status, or -1 when it cannot be started.
int run(const std::vector<std::string>& words, const fs::path& log) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t child = 0;
  const int failed = posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed) return -1;
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

// The first lines of what the compiler said.
std::string said(const fs::path& log) {
  std::ifstream file(log);
  std::string text, line;
  for (int i = 0; i < 8 && std::getline(file, line); ++i) text += "\n  " + line;
  return text;
}

// The files to compile; the code and its C interface in one.
std::vector<std::string> sources_of(const fs::path& folder, const std::vector<backend::OutputFile>& files) {
  const std::string code = "dynamics.cpp", interface = "c_api.cpp";
  const auto has = [&](const std::string& name) {
    return std::any_of(files.begin(), files.end(), [&](const backend::OutputFile& file) { return file.name == name; });
  };
  const bool both = has(code) && has(interface);
  std::vector<std::string> sources;
  if (both) {
    sources.push_back((folder / "code_and_interface.cpp").string());
    std::ofstream(sources.front()) << fmt::format("#include \"{}\"\n#include \"{}\"\n", code, interface);
  }
  for (const backend::OutputFile& file : files)
    if (file.name.ends_with(".cpp") && !(both && (file.name == code || file.name == interface)))
      sources.push_back((folder / file.name).string());
  return sources;
}

}  // namespace

std::vector<std::string> compiler_words(const CompilerOptions& options) {
  for (const std::string& given : {options.compiler, environment("CXX")})
    if (const std::vector<std::string> words = split(given, ' '); !words.empty()) return words;
  return {"c++"};
}

// The runtime's headers stand beside an installed executable, or in the source folder of a built one.
std::vector<std::string> include_folders() {
  if (const std::vector<std::string> given = split(environment("DALEMBERT_INCLUDE"), ':'); !given.empty()) return given;
  std::vector<std::string> folders;
  std::error_code error;
  const fs::path installed = fs::read_symlink("/proc/self/exe", error).parent_path().parent_path() / "include";
  for (const fs::path& folder : {installed, fs::path(DALEMBERT_RUNTIME_INCLUDE)})
    if (folders.empty() && fs::exists(folder / "dalembert" / "version.hpp", error)) folders.push_back(folder.string());
  for (const std::string& folder : split(DALEMBERT_EIGEN_INCLUDE, ':')) folders.push_back(folder);
  return folders;
}

std::vector<std::string> include_words() {
  std::vector<std::string> words;
  for (const std::string& folder : include_folders())
    if (folder != "/usr/include" && folder != "/usr/local/include") words.insert(words.end(), {"-isystem", folder});
  return words;
}

std::vector<std::string> compiler_and_flags(const CompilerOptions& options) {
  std::vector<std::string> command = compiler_words(options);
  for (std::string& flag : split(options.flags, ' ')) command.push_back(std::move(flag));
  if (options.lanes > 0) command.push_back(fmt::format("-DDALEMBERT_LANES={}", options.lanes));
  return command;
}

void run_compiler(const std::vector<std::string>& command, const fs::path& log) {
  const int status = run(command, log);
  if (status == -1 || status == 127)
    refuse(fmt::format("'{}' cannot be run", command.front()),
           "install g++, or name a C++17 compiler with --compiler or CXX; eval needs none with --engine generic");
  if (status != 0)
    refuse(
        fmt::format("'{}' does not compile the generated code:{}", command.front(), said(log)),
        "name a C++17 compiler with --compiler or CXX, flags it knows with --flags, and the folders of dalembert's and Eigen's "
        "headers with DALEMBERT_INCLUDE");
}

std::string complaint(const std::runtime_error& error) {
  const auto* const refused = dynamic_cast<const InputError*>(&error);
  const std::string text = refused ? refused->diagnostics().front().message : error.what();
  for (const std::string& line : split(text, '\n')) {
    if (const size_t at = line.find("error: "); at != line.npos) return line.substr(at + 7);
    if (const size_t at = line.find("cannot find "); at != line.npos) return line.substr(at);
  }
  return text.substr(0, text.find('\n'));
}

LoadedCode::LoadedCode(const std::string& name, const std::vector<backend::OutputFile>& files, const CompilerOptions& options) {
  const TemporaryFolder folder;
  const fs::path sources = folder.path() / name, object = folder.path() / "code.so", log = folder.path() / "log";
  backend::write_files(sources.string(), files);
  std::vector<std::string> command = compiler_and_flags(options);
  command_ = fmt::format("{}", fmt::join(command, " "));
  for (const char* word : {"-shared", "-fPIC"}) command.push_back(word);
  command.push_back("-I" + folder.path().string());
  for (const std::string& word : include_words()) command.push_back(word);
  if (!options.precompiled.empty()) command.insert(command.end(), {"-include", options.precompiled});
  for (const std::string& source : sources_of(sources, files)) command.push_back(source);
  for (const std::string& word : split(options.libraries, ' ')) command.push_back(word);
  command.push_back("-o");
  command.push_back(object.string());

  run_compiler(command, log);
  // Libraries may have threads that outlive the code, as oneTBB does: they stay.
  library_ = dlopen(object.c_str(), RTLD_NOW | RTLD_LOCAL | (options.libraries.empty() ? 0 : RTLD_NODELETE));
  if (!library_) throw std::runtime_error(std::string("the compiled code cannot be loaded: ") + dlerror());
}

LoadedCode::~LoadedCode() {
  if (library_) dlclose(library_);
}

bool LoadedCode::has(const std::string& name) const { return dlsym(library_, name.c_str()) != nullptr; }

void* LoadedCode::address(const std::string& name) const {
  void* address = dlsym(library_, name.c_str());
  if (!address) throw std::runtime_error("the generated code has no function " + name);
  return address;
}

}  // namespace dalembert
