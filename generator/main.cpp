// dalembert: arguments → one command → exit code. 0 good, 1 a check failed, 2 bad input or usage.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "commands/info.hpp"

namespace {
void print(const dalembert::Diagnostics& diagnostics) {
  for (const dalembert::Diagnostic& d : diagnostics) fmt::print(stderr, "{}\n", to_string(d));
}
}  // namespace

int main(int argc, char** argv) {
  dalembert::Diagnostics warnings;
  try {
    CLI::App app{"A dynamics compiler: URDF in, robot-specific C++ out.", "dalembert"};
    app.require_subcommand(1);
    dalembert::Request request;
    CLI::App* info = app.add_subcommand("info", "The robot as the compiler sees it");
    info->add_option("robot", request.robot, "URDF file")->required();
    CLI11_PARSE(app, argc, argv);
    const std::string text = describe(dalembert::read_model(request, warnings));
    print(warnings);
    std::fputs(text.c_str(), stdout);
    return 0;
  } catch (const dalembert::InputError& error) {
    print(warnings);
    print(error.diagnostics());
    return 2;
  }
}
