#include "commands/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <dalembert/version.hpp>
#include <exception>
#include <filesystem>
#include <functional>
#include <iterator>
#include <memory>
#include <sstream>

#include "commands/build.hpp"
#include "commands/cache.hpp"
#include "commands/calibrate.hpp"
#include "commands/check.hpp"
#include "commands/dump.hpp"
#include "commands/eval.hpp"
#include "commands/generate.hpp"
#include "commands/info.hpp"
#include "commands/machine.hpp"
#include "commands/manual.hpp"
#include "commands/measure_plan.hpp"
#include "commands/options.hpp"
#include "commands/package.hpp"
#include "commands/registry.hpp"
#include "commands/report.hpp"
#include "commands/task_report.hpp"
#include "frontend/nearest.hpp"

namespace dalembert {

namespace {

constexpr int good = 0, check_failed = 1, bad_input = 2;

constexpr const char* first_steps =
    "begin with one of these, or with 'dalembert --help':\n"
    "  dalembert info ROBOT.urdf                           the robot as the compiler sees it\n"
    "  dalembert check ROBOT.urdf                          its code compiled, compared with exact results, and timed\n"
    "  dalembert generate ROBOT.urdf --base fixed -o DIR   its code, here of an arm that stands on something";

void print(const Diagnostics& diagnostics, bool verbose = false) {
  for (const std::string& line : lines(diagnostics, verbose)) tell(line + "\n");
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

// How the commands that compile generated code do it.
std::shared_ptr<CompilerOptions> add_compiler_options(CLI::App& parser) {
  const auto options = std::make_shared<CompilerOptions>();
  parser.add_option("--compiler", options->compiler, "C++ compiler of the generated code, default $CXX or c++")
      ->type_name("COMMAND");
  parser.add_option("--flags", options->flags, "all of the compiler's flags")->capture_default_str()->type_name("FLAGS");
  parser
      .add_option("--lanes", options->lanes,
                  "numbers side by side in loops over branches; default: what the target's registers hold")
      ->check(CLI::IsMember({1, 2, 4, 8}))
      ->type_name("1|2|4|8");
  return options;
}

// The command's request, with a plan measured where that is asked for; `told` is what to print of it.
Request planned_request(const Command& command, const CompilerOptions& compiler, std::string& told) {
  Request request = command.shared.request();
  if (asks_to_measure(request)) return with_measured_plan(std::move(request), compiler, told);
  for (const char* name : {"--compiler", "--flags", "--lanes"})
    if (command.parser.get_option(name)->count() > 0)
      throw InputError({Severity::error, "", std::string("option ") + name, "nothing is compiled without --plan measure",
                        "leave it out, or measure"});
  return request;
}

void add_generate(Command& command) {
  const auto folder = std::make_shared<std::string>();
  command.parser.add_option("-o,--out", *folder, "folder for the generated files; made when missing")
      ->required()
      ->type_name("DIR");
  const auto package = std::make_shared<bool>(false);
  command.parser.add_flag(
      "--package", *package,
      "a package of its own instead, that needs no generator: the code in a folder below, headers, CMakeLists.txt, "
      "package.xml, README.md");
  const auto language = std::make_shared<std::string>("c++");
  command.parser
      .add_option("--language", *language,
                  "c: code of which the C header NAME.h is promised and nothing else, for hosts in C; default c++")
      ->check(CLI::IsMember({"c++", "c"}))
      ->excludes("--package")
      ->type_name("c++|c");
  const auto depfile = std::make_shared<std::string>();
  const CLI::Option* const writes_rule =
      command.parser
          .add_option(
              "--depfile", *depfile,
              "written as well: a rule for make and ninja that FILE, less its .d, is made of the robot's files, included ones "
              "too, and the scene")
          ->type_name("FILE.d");
  const auto compiler = add_compiler_options(command.parser);
  command.run = [&command, folder, package, language, depfile, writes_rule, compiler](Diagnostics& warnings) {
    backend::check_folder(*folder);
    if (writes_rule->count() > 0) check_depfile(*depfile);
    std::string told;
    const Request request = planned_request(command, *compiler, told);
    const Model model = read_model(request, warnings);
    const bool alone = *package || *language == "c";  // and needs no library but Eigen
    if (alone && model.scene.parallel == ir::Parallel::tasks)
      warnings.push_back({Severity::warning, "", "key 'parallel'",
                          fmt::format("task graphs are left out of {}", *package ? "packages" : "code for hosts in C"),
                          "generate without --package and --language c to have them, and link oneTBB"});
    const std::string done = *package           ? generate_package(model, *folder)
                             : *language == "c" ? generate_c(model, *folder)
                                                : generate(model, *folder);
    if (writes_rule->count() > 0) write_depfile(*depfile, model, request.scene_file);
    return print_result(told + done);
  };
}

void add_info(Command& command) {
  const auto json = std::make_shared<bool>(false);
  command.parser.add_flag("--json", *json, "one JSON object for machines");
  const auto stage = std::make_shared<std::string>();
  command.parser.add_option("--dump", *stage, "instead: what a pass has made of the robot, and the operations after each pass")
      ->check(CLI::IsMember(std::vector<std::string>(std::begin(stage_names), std::end(stage_names))))
      ->excludes("--json")
      ->type_name("tree|normal_tree|program|plan|rolled");
  const auto threads = std::make_shared<int>(0);
  CLI::Option* const asked =
      command.parser
          .add_option("--threads", *threads,
                      "instead: what the task graph of one call is expected to gain on so many threads, and on 1 to 64")
          ->check(CLI::Range(1, 64))
          ->excludes("--json")
          ->excludes("--dump")
          ->type_name("1..64");
  const auto picture = std::make_shared<std::string>();
  command.parser.add_option("--schedule", *picture, "with --threads: a picture (SVG) of which thread runs which task when")
      ->needs(asked)
      ->type_name("FILE");
  const auto compiler = add_compiler_options(command.parser);
  command.run = [&command, json, stage, threads, picture, compiler](Diagnostics& warnings) {
    std::string told;
    const Model model = read_model(planned_request(command, *compiler, told), warnings);
    if (*threads > 0) {
      const std::vector<FunctionTasks> tasks = tasks_of_functions(model, lower(model));
      if (!picture->empty()) {
        const std::filesystem::path file(*picture);
        backend::add_files(file.has_parent_path() ? file.parent_path().string() : ".",
                           {{file.filename().string(), tasks_svg(tasks, *threads)}});
      }
      return print_result(tasks_text(tasks, *threads));
    }
    if (stage->empty() && !*json) return print_result(describe(model) + (told.empty() ? "" : "\n" + told));
    if (!told.empty()) tell(told);
    if (stage->empty()) return print_result(describe_json(model));
    const auto at = std::find(std::begin(stage_names), std::end(stage_names), *stage);
    return print_result(dump(model, static_cast<Stage>(at - std::begin(stage_names))));
  };
}

void add_eval(Command& command) {
  struct Options {
    std::string state, output, engine = "generated";
    bool labels = false, json = false;
  };
  const auto options = std::make_shared<Options>();
  command.parser
      .add_option(
          "--state", options->state,
          "states, one a line: q, v, then dv/dt for inverse dynamics, its derivatives and the regressor, or tau for forward "
          "dynamics and its derivatives, of a function of the scene what it takes, then six numbers for each of the scene's "
          "wrenches; numbers separated by blanks; - for standard input")
      ->required()
      ->type_name("FILE");
  command.parser
      .add_option("--output", options->output,
                  "the quantity to print, of a link QUANTITY_LINK, of a function of the scene FUNCTION_QUANTITY")
      ->required()
      ->type_name("QUANTITY");
  command.parser
      .add_option("--engine", options->engine, "who computes; default generated, which as batch needs a C++ compiler")
      ->check(CLI::IsMember({"generic", "generated", "batch"}))
      ->type_name("generic|generated|batch");
  CLI::Option* const labels = command.parser.add_flag("--labels", options->labels,
                                                      "names of joints and axes beside the numbers, which have six digits");
  command.parser.add_flag("--json", options->json, "one JSON object: names of rows and columns, unit, and the numbers")
      ->excludes(labels);
  const auto compiler = add_compiler_options(command.parser);
  command.run = [&command, options, compiler](Diagnostics& warnings) {
    Request request = command.shared.request();
    request.for_one_output = true;
    const Model model = read_model(request, warnings);
    const Engine engine = options->engine == "generic" ? Engine::generic
                          : options->engine == "batch" ? Engine::batch
                                                       : Engine::generated;
    for (const char* option : {"--compiler", "--flags", "--lanes"})
      if (engine == Engine::generic && command.parser.count(option) > 0)
        warnings.push_back({Severity::warning, "", fmt::format("option {}", option),
                            "it is ignored: the generic engine compiles nothing", "leave it out, or take --engine generated"});
    const Style style = options->labels ? Style::labels : options->json ? Style::json : Style::numbers;
    return print_result(evaluate(model, options->state, options->output, engine, style, *compiler, warnings));
  };
}

void add_check(Command& command) {
  const auto compiler = add_compiler_options(command.parser);
  const auto together = std::make_shared<bool>(false);
  command.parser.add_flag("--together", *together,
                          "only what all outputs are computed by in one, not each by code of its own as well: compiles less");
  command.run = [&command, compiler, together](Diagnostics& warnings) {
    const CheckReport report = check(read_model(command.shared.request(), warnings), *compiler,
                                     *together ? Pieces::together : Pieces::each_and_together);
    const int printed = print_result(report.text);
    return printed != good || report.passed ? printed : check_failed;
  };
}

void add_report(Command& command) {
  const auto options = std::make_shared<ReportOptions>();
  command.parser.add_option("-o,--out", options->folder, "folder for index.html and report.csv; made when missing")
      ->required()
      ->type_name("DIR");
  command.parser.add_flag("--quick", options->quick, "fewer variants and states: under a minute for most robots");
  const auto compiler = add_compiler_options(command.parser);
  command.run = [&command, options, compiler](Diagnostics& warnings) {
    const Model model = read_model(command.shared.request(), warnings);
    if (model.scene.scalar == ir::ScalarType::float32)
      warnings.push_back({Severity::notice, "", "key 'scalar'", "the page's sentences and the exit status are of double code",
                          "errors and times of float stand in its tables"});
    const ReportSummary summary = write_report(model, *compiler, *options);
    const int printed = print_result(summary.text);
    return printed != good || summary.passed ? printed : check_failed;
  };
}

void add_build(Command& command) {
  const auto compiler = add_compiler_options(command.parser);
  command.run = [&command, compiler](Diagnostics& warnings) {
    try {
      return print_result(build(command.shared.request(), *compiler, warnings) + "\n");
    } catch (const SelfTestFailure& failure) {
      print({{Severity::error, command.shared.request().robot, "self-test", failure.what(),
              "name another compiler with --compiler, or other flags with --flags; 'dalembert check' tells more"}});
      return check_failed;
    }
  };
}

// A command that takes no robot.
struct PlainCommand {
  CLI::App* parser;
  std::function<int()> run;
};

PlainCommand add_cache(CLI::App& app) {
  CLI::App* const parser = app.add_subcommand("cache", "List what 'build' and Python have compiled and kept, or remove it");
  const auto clear = std::make_shared<bool>(false);
  parser->add_flag("--clear", *clear, "remove all of it; what is being compiled at this moment stays");
  return {parser, [clear] {
            if (*clear) return print_result(fmt::format("{} removed from {}\n", clear_cache(), cache_folder().string()));
            std::string text;
            std::uintmax_t bytes = 0;
            const std::vector<CacheEntry> entries = cache_entries();
            for (const CacheEntry& entry : entries) {
              text += fmt::format("{}  {:>8} kB  {}\n", entry.folder.filename().string(), (entry.bytes + 999) / 1000,
                                  command_line_of(entry.folder));
              bytes += entry.bytes;
            }
            return print_result(
                text + fmt::format("{} in {}, {} kB\n", entries.size(), cache_folder().string(), (bytes + 999) / 1000));
          }};
}

PlainCommand add_calibrate(CLI::App& app) {
  CLI::App* const parser = app.add_subcommand(
      "calibrate", "Measure what this machine takes for what calls are made of, and keep it for --calibrated");
  const auto compiler = add_compiler_options(*parser);
  return {parser, [compiler] { return print_result(calibrate(*compiler).text); }};
}

// For programs that have loaded what 'build' made.
PlainCommand add_build_batches(CLI::App& app) {
  CLI::App* const parser =
      app.add_subcommand("build-batches", "Compile batches of what 'build' has made, where there are none yet");
  parser->group("");
  const auto entry = std::make_shared<std::string>();
  const auto parts = std::make_shared<std::vector<size_t>>();
  parser->add_option("FOLDER", *entry, "the entry of the cache")->required();
  parser->add_option("PART", *parts, "numbers of its parts")->required();
  return {parser, [entry, parts] {
            try {
              build_batches(*entry, *parts);
            } catch (const SelfTestFailure& failure) {
              print({{Severity::error, *entry, "self-test", failure.what(),
                      "load the robot with batch=False, or with other flags"}});
              return check_failed;
            }
            return good;
          }};
}

PlainCommand add_quantities(CLI::App& app) {
  CLI::App* const parser =
      app.add_subcommand("quantities", "List what can be asked for: the values of --outputs, and of --frames");
  const auto json = std::make_shared<bool>(false);
  parser->add_flag("--json", *json, "one JSON object for machines, with the scene's keys");
  return {parser, [json] { return print_result(*json ? registry_json() : registry_text()); }};
}

// For those who make packages.
PlainCommand add_page(CLI::App& app, const char* name, const char* help,
                      const std::function<std::string(const CLI::App&)>& page) {
  CLI::App* const parser = app.add_subcommand(name, help);
  parser->group("");
  return {parser, [&app, page] { return print_result(page(app)); }};
}

// Most likely a variable of the shell that is not set. The scene's keys check themselves: an empty list is a value.
void refuse_empty_options(const CLI::App& parser) {
  for (const char* name : {"--scene", "--name", "--out", "--compiler", "--state", "--output"}) {
    const CLI::Option* option = parser.get_option_no_throw(name);
    if (option && option->count() > 0 && option->results().back().empty())
      throw InputError({Severity::error, "", std::string("option ") + name, "its value is empty",
                        option->get_required() ? "give one" : "give one, or leave the option out"});
  }
}

// What to do about words that nothing takes: the nearest command or option.
std::string remedy_of(const CLI::App& app, int argc, const char* const* argv) {
  const std::string first = argv[1];
  const CLI::App* command = nullptr;
  std::vector<std::string> commands;
  for (const CLI::App* const each : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (each->get_name() == first) command = each;
    if (!each->get_group().empty()) commands.push_back(each->get_name());
  }
  if (!command && !first.starts_with('-'))
    return fmt::format("there is no command '{}'; {}", first, frontend::suggestion(first, commands));
  if (!command) return "run 'dalembert --help', or a command with --help";
  std::vector<std::string> options;
  for (const CLI::Option* const option : command->get_options()) options.push_back(option->get_name());
  for (int i = 2; i < argc; ++i) {
    const std::string word = argv[i], name = word.substr(0, word.find('='));
    if (!name.starts_with("--") || command->get_option_no_throw(name)) continue;
    return fmt::format("there is no option {}; {}", name, frontend::suggestion(name, options));
  }
  return fmt::format("run 'dalembert {} --help'", first);
}

int parse_and_run(int argc, const char* const* argv, Diagnostics& warnings, bool& verbose) {
  CLI::App app{"A dynamics compiler: URDF in, C++ for that one robot out.", "dalembert"};
  app.require_subcommand(1);
  app.set_version_flag("--version", fmt::format("dalembert {}, runtime {}", DALEMBERT_VERSION, runtime_version),
                       "The version of this program, and of the runtime its code needs");
  app.add_flag_callback(
      "--machine",
      [] {
        const Machine machine = this_machine();
        throw CLI::CallForVersion(machine.kind + "\n" + machine.details, 0);  // prints it
      },
      "What figures measured here say they were measured on, what others need not share in a second line");
  app.footer("Exit status: 0 good, 1 a check failed, 2 bad input or usage.");

  Command generate(app, "generate", "Write a robot's dynamics as C++ files");
  Command info(app, "info", "Show the robot as the compiler sees it: tree, coordinates, links, sparsity, operation counts");
  Command eval(app, "eval", "Print a quantity at given states");
  Command check(app, "check", "Compare generated code with the generic engine, in double and in 50 digits, and time it");
  Command report(app, "report", "Measure error against time, extreme cases and forms, as a page and a table");
  Command build(app, "build", "Compile a robot's functions for programs that load them, such as Python; print the folder");
  const PlainCommand plain[] = {
      add_cache(app),
      add_calibrate(app),
      add_quantities(app),
      add_build_batches(app),
      add_page(app, "manual", "Print the manual page", [](const CLI::App& of) { return manual_page(of, DALEMBERT_VERSION); }),
      add_page(app, "completion", "Print the completion script of bash", bash_completion)};
  add_generate(generate);
  add_info(info);
  add_eval(eval);
  add_check(check);
  add_report(report);
  add_build(build);

  if (argc < 2) throw InputError({Severity::error, "", "command line", "no command is given", first_steps});
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {  // --help
      std::ostringstream text;
      app.exit(error, text);
      return print_result(text.str());
    }
    throw InputError({Severity::error, "", "command line", error.what(), remedy_of(app, argc, argv)});
  }
  for (const PlainCommand& command : plain)
    if (command.parser->parsed()) return command.run();
  for (const Command* command : {&generate, &info, &eval, &check, &report, &build})
    if (command->parser.parsed()) {
      refuse_empty_options(command->parser);
      verbose = command->shared.verbose();
      return command->run(warnings);
    }
  return bad_input;
}

}  // namespace

int run(int argc, const char* const* argv) {
  Diagnostics warnings, errors;
  int status = bad_input;
  bool verbose = false;
  try {
    status = parse_and_run(argc, argv, warnings, verbose);
  } catch (const InputError& error) {
    errors = error.diagnostics();
  } catch (const std::exception& error) {
    errors = {{Severity::error, "", "dalembert", error.what(), "this is a defect of dalembert: please report it"}};
  }
  // What failed has taken nothing for granted.
  if (!errors.empty()) std::erase_if(warnings, [](const Diagnostic& d) { return d.severity == Severity::notice; });
  print(warnings, verbose);
  print(errors);
  return status;
}

}  // namespace dalembert
