// The command line of `dalembert`, from arguments to the exit code.
#pragma once

namespace dalembert {

// Runs one command. Results go to stdout and diagnostics to stderr. Returns 0 when good, 1 when a check failed, 2 for bad
// input or usage; lets no exception out.
int run(int argc, const char* const* argv);

}  // namespace dalembert
