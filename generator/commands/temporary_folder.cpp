#include "commands/temporary_folder.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>

#include "diagnostics.hpp"

extern char** environ;

namespace dalembert {

namespace fs = std::filesystem;

TemporaryFolder::TemporaryFolder() {
  std::error_code error;
  std::string pattern = (fs::temp_directory_path(error) / "dalembert.XXXXXX").string();
  if (error || !mkdtemp(pattern.data())) {
    const char* asked = std::getenv("TMPDIR");
    const std::string place = asked ? "TMPDIR=" + std::string(asked) : "temporary folder";
    throw InputError({Severity::error, "", place, "no folder can be made there for what is compiled",
                      "set TMPDIR to a folder that can be written"});
  }
  path_ = pattern;
  // Signals end this program at once, whatever its threads and compilers are at; nothing of it can run then. Nor do they reach
  // whoever is in another group and blocks them.
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return;
  for (int& end : ends) {  // where the standard ones are closed, they are not to be taken for them
    const int higher = fcntl(end, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    close(std::exchange(end, higher));
  }
  std::string shell = "sh", option = "-c", name = "dalembert", path = path_.string(),
              text = R"(PATH=/usr/bin:/bin; while read -r nothing; do :; done; rm -rf -- "$1" || { sleep 1; rm -rf -- "$1"; })";
  char* const arguments[] = {shell.data(), option.data(), text.data(), name.data(), path.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  sigset_t ending;
  sigemptyset(&ending);
  for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGTERM}) sigaddset(&ending, signal);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setsigmask(&attributes, &ending);
  if (posix_spawn(&keeper_, "/bin/sh", &actions, &attributes, arguments, environ) != 0) keeper_ = 0;
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[0]);
  alive_ = ends[1];
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  if (alive_ >= 0) close(alive_);
  while (keeper_ > 0 && waitpid(keeper_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

}  // namespace dalembert
