#include "commands/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <functional>

#include "commands/info.hpp"
#include "commands/options.hpp"

namespace dalembert {

namespace {

constexpr int good = 0, bad_input = 2;

void print(const Diagnostics& diagnostics) {
  for (const Diagnostic& d : diagnostics) fmt::print(stderr, "{}\n", to_string(d));
}

// Results whole or not at all: a full disk or a closed pipe is not success.
int print_result(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0) return good;
  print({{Severity::error, "", "standard output", "the result cannot be written", "look for a full disk or a closed pipe"}});
  return bad_input;
}

// One command: its options, and what to do with them.
struct Command {
  Command(CLI::App& app, const char* name, const char* help) : parser(*app.add_subcommand(name, help)), shared(parser) {}

  CLI::App& parser;
  SharedOptions shared;
  std::function<int(Diagnostics& warnings)> run;
};

void add_info(Command& command, bool& json) {
  command.parser.add_flag("--json", json, "one JSON object for machines");
  command.run = [&](Diagnostics& warnings) {
    const Model model = read_model(command.shared.request(), warnings);
    return print_result(json ? describe_json(model, {}) : describe(model, {}));
  };
}

int parse_and_run(int argc, const char* const* argv, Diagnostics& warnings) {
  CLI::App app{"A dynamics compiler: URDF in, C++ for that one robot out.", "dalembert"};
  app.require_subcommand(1);
  app.footer("Exit status: 0 good, 1 a check failed, 2 bad input or usage.");

  Command info(app, "info", "The robot as the compiler sees it: tree, coordinates, links, sparsity, operation counts");
  bool json = false;
  add_info(info, json);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help
    throw InputError({Severity::error, "", "command line", error.what(), "run 'dalembert --help', or a command with --help"});
  }
  for (const Command* command : {&info})
    if (command->parser.parsed()) return command->run(warnings);
  return bad_input;
}

}  // namespace

int run(int argc, const char* const* argv) {
  Diagnostics warnings, errors;
  int status = bad_input;
  try {
    status = parse_and_run(argc, argv, warnings);
  } catch (const InputError& error) {
    errors = error.diagnostics();
  } catch (const std::exception& error) {
    errors = {{Severity::error, "", "dalembert", error.what(), "this is a defect of dalembert: please report it"}};
  }
  print(warnings);
  print(errors);
  return status;
}

}  // namespace dalembert
