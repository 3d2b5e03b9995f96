#include "frontend/robot_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <sstream>
#include <string_view>
#include <utility>

#include "frontend/numbers.hpp"
#include "frontend/sdf_reader.hpp"
#include "frontend/text_file.hpp"
#include "frontend/urdf_reader.hpp"
#include "frontend/xml_document.hpp"

extern char** environ;

namespace dalembert::frontend {

namespace {

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

std::string text_of(std::FILE* file) {
  std::string text;
  std::rewind(file);
  char block[4096];
  for (size_t read; (read = std::fread(block, 1, sizeof block, file)) > 0;) text.append(block, read);
  return text;
}

bool is_xacro(const std::string& path) { return path.ends_with(".xacro"); }
bool is_sdf(const std::string& path) { return path.ends_with(".sdf") || path.ends_with(".world"); }

// Why xacro fails, in one line. xacro says what is wrong first ("error: name 'm' is not defined"), then where it was met ("when
// evaluating expression 'm'"), up to the file, which is told only where it is another one. Anything else ends with what
// matters: of a trace of Python's, the exception.
std::string cause(const std::string& text, const std::string& path) {
  constexpr std::string_view error = "error: ", of_xml = "XML parsing error: ";
  std::istringstream lines(text);
  std::string said, last;
  bool what = false;  // whether lines say what is wrong, and not yet where
  for (std::string line; std::getline(lines, line);) {
    line = std::string(trimmed(line));
    if (!line.empty()) last = line;
    if (said.empty()) {
      what = line.starts_with(error) || line.starts_with(of_xml);
      if (what) said = line.starts_with(error) ? line.substr(error.size()) : line;
      continue;
    }
    if (line.empty()) break;  // general advice follows
    const bool file = line.starts_with("when processing file: ") || line.starts_with("in file: ");
    const bool where = file || line.starts_with("when ");
    what = what && !where;
    if (what || (where && !(file && line.ends_with(": " + path)))) said += ", " + line;
  }
  if (!said.empty()) return said;
  return last.empty() ? "it says nothing" : last;
}

struct Said {
  std::string printed, complaints;
};

Said run_xacro(const std::string& path, const char* option = nullptr) {
  const auto refuse = [&](const std::string& what, const char* remedy) {
    throw InputError({Severity::error, path, "xacro", what, remedy});
  };
  (void)read_text_file(path, "xacro", xml_bytes);  // whether it can be read is said by us
  if (path.find(":=") != path.npos)
    refuse("xacro takes a name with ':=' for an argument", "give the file or folder another name");
  const File out(std::tmpfile(), std::fclose), err(std::tmpfile(), std::fclose);
  if (!out || !err) refuse("there is no room for a temporary file", "set TMPDIR to a folder that can be written");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, fileno(out.get()), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(err.get()), STDERR_FILENO);
  std::vector<std::string> words{"xacro"};
  if (option) words.push_back(option);
  words.push_back(path.starts_with('-') ? "./" + path : path);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  const int failed = posix_spawnp(&child, "xacro", &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  while (!failed && waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (failed || (WIFEXITED(status) && WEXITSTATUS(status) == 127))
    refuse("the program xacro is not installed, and the file has to be expanded",
           "install ROS's xacro and put it on PATH, or expand the file elsewhere: xacro FILE > robot.urdf");
  Said said{text_of(out.get()), text_of(err.get())};
  if (status != 0)
    refuse("xacro fails: " + cause(said.complaints, path),
           "correct the file; where it needs arguments, run xacro yourself: xacro FILE NAME:=VALUE > robot.urdf");
  return said;
}

// What xacro warns of while it expands, one warning per paragraph.
void pass_on(const std::string& complaints, const std::string& path, Diagnostics& warnings) {
  std::istringstream lines(complaints);
  std::string warning;
  const auto done = [&] {
    if (!warning.empty())
      warnings.push_back({Severity::warning, path, "xacro", "xacro says: " + warning, "see to it that it has nothing to say"});
    warning.clear();
  };
  for (std::string line; std::getline(lines, line);) {
    constexpr std::string_view begins = "warning: ";
    line = std::string(trimmed(line));
    if (line.empty() || line.starts_with(begins)) done();
    if (line.starts_with(begins)) line.erase(0, begins.size());
    if (!line.empty()) warning += (warning.empty() ? "" : ", ") + line;
  }
  done();
}

// Without what a comment says of how the file was called.
std::string without_its_name(std::string expanded) {
  constexpr std::string_view said = "autogenerated by xacro from";
  const size_t at = expanded.find(said), end = expanded.find("-->", at);
  if (end != expanded.npos) expanded.erase(at + said.size(), end - at - said.size());
  return expanded;
}

}  // namespace

ir::RobotDescription read_robot(const std::string& path, Diagnostics& warnings) {
  if (is_sdf(path)) return read_sdf(path, warnings);
  if (!is_xacro(path)) return read_urdf(path, warnings);
  const Said said = run_xacro(path);
  pass_on(said.complaints, path, warnings);
  if (said.printed.find("<link") == said.printed.npos &&
      read_text_file(path, "xacro", xml_bytes).find("<xacro:macro") != std::string::npos)
    throw InputError({Severity::error, path, "xacro",
                      "it expands to no links: the file defines macros and calls none that has them",
                      "name the file that includes this one and calls its macros"});
  ir::RobotDescription robot = read_urdf_text(path + ", expanded", said.printed, warnings);  // whose lines they are
  robot.files = {path};
  robot.text = without_its_name(said.printed);
  return robot;
}

std::string robot_text(const std::string& path) {
  if (is_xacro(path)) return without_its_name(run_xacro(path).printed);
  std::error_code ignored;
  std::string text;
  if (!std::filesystem::is_directory(path, ignored)) {
    std::ifstream file(path, std::ios::binary);
    text.assign(std::istreambuf_iterator<char>(file), {});
  }
  // libsdformat, which finds what is included, takes longer to load than all else that is done for compiled code that is there.
  if (!is_sdf(path) || text.find("<include") == text.npos) return text;
  try {
    Diagnostics said_again;
    return read_sdf(path, said_again).text;
  } catch (const InputError&) {  // said again, too
    return text;
  }
}

std::vector<std::string> files_of(const ir::RobotDescription& robot) {
  namespace fs = std::filesystem;
  std::vector<std::string> files;
  const auto add = [&](const std::string& file) {
    const std::string path = fs::absolute(file).lexically_normal().string();
    if (std::find(files.begin(), files.end(), path) == files.end()) files.push_back(path);
  };
  for (const std::string& file : robot.files) add(file);
  if (!is_xacro(robot.files.front())) return files;
  // Names one behind another, of which some may have blanks.
  std::istringstream words(run_xacro(robot.files.front(), "--deps").printed);
  std::error_code ignored;
  std::string name;
  for (std::string word; words >> word;) {
    name = name.empty() || fs::is_regular_file(word, ignored) ? word : name + " " + word;
    if (fs::is_regular_file(name, ignored)) add(std::exchange(name, ""));
  }
  return files;
}

}  // namespace dalembert::frontend
