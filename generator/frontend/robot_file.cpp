#include "frontend/robot_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <memory>
#include <sstream>
#include <string_view>

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

}  // namespace

bool is_xacro(const std::string& path) { return path.ends_with(".xacro"); }

std::string expanded_xacro(const std::string& path) {
  const auto refuse = [&](const std::string& what, const char* remedy) {
    throw InputError({Severity::error, path, "xacro", what, remedy});
  };
  (void)read_text_file(path, "xacro", xml_bytes);  // whether it can be read is said by us
  const File out(std::tmpfile(), std::fclose), err(std::tmpfile(), std::fclose);
  if (!out || !err) refuse("there is no room for a temporary file", "set TMPDIR to a folder that can be written");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, fileno(out.get()), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(err.get()), STDERR_FILENO);
  std::string program = "xacro", file = path;
  char* const arguments[] = {program.data(), file.data(), nullptr};
  pid_t child = 0;
  const int failed = posix_spawnp(&child, "xacro", &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  while (!failed && waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (failed || (WIFEXITED(status) && WEXITSTATUS(status) == 127))
    refuse("the program xacro is not installed, and the file has to be expanded",
           "install ROS's xacro and put it on PATH, or expand the file elsewhere: xacro FILE > robot.urdf");
  if (status != 0)
    refuse("xacro fails: " + cause(text_of(err.get()), path),
           "correct the file; where it needs arguments, run xacro yourself: xacro FILE NAME:=VALUE > robot.urdf");
  return text_of(out.get());
}

ir::RobotDescription read_robot(const std::string& path, Diagnostics& warnings) {
  if (is_xacro(path)) return read_urdf_text(path, expanded_xacro(path), warnings);
  if (path.ends_with(".sdf") || path.ends_with(".world")) return read_sdf(path, warnings);
  return read_urdf(path, warnings);
}

}  // namespace dalembert::frontend
