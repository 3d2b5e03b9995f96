// dalembert: arguments → one command → exit code. 0 good, 1 a check failed, 2 bad input or usage.
#include <fcntl.h>
#include <unistd.h>

#include <initializer_list>

#include "commands/command_line.hpp"

namespace {
// Where a standard stream is closed, the next file that is opened would take its place and get what is meant for it. What is
// opened here instead can be neither read from nor written to as the stream is.
void close_gaps() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) == -1) open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}
}  // namespace

int main(int argc, char** argv) {
  close_gaps();
  return dalembert::run(argc, argv);
}
