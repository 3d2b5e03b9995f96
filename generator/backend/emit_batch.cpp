#include "backend/emit_batch.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "backend/batch_function.hpp"
#include "backend/code_name.hpp"
#include "backend/code_text.hpp"
#include "backend/emit_header.hpp"
#include "backend/literals.hpp"
#include "backend/templates.hpp"
#include "diagnostics.hpp"
#include "ir/run_time_inputs.hpp"

namespace dalembert::backend {
namespace {

using ir::RunTimeInput;

// Beside the member of a batch that has one for each state.
std::string comment_of_each(const RunTimeInput& input) {
  return fmt::format("{} numbers each{}: {}", input.size(),
                     input.type.empty() ? "" : fmt::format(", in the order of {}", input.type), comment_text(input.meaning));
}

std::string given_members(const CodeInput& code) {
  if (!reads_workspace(code)) return "";
  std::string text =
      "  // Run-time inputs: those of this workspace for all states, or without one what a new workspace has; or, where there "
      "is "
      "a\n"
      "  // pointer, one for each state, laid out as states are.\n"
      "  const Workspace* workspace = nullptr;\n";
  for (const RunTimeInput& g : ir::run_time_inputs(code.scene))
    text += fmt::format("  const Scalar* {} = nullptr;  // {}\n", g.each, comment_of_each(g));
  return text;
}

std::vector<const CodeInput*> batched(const Folder& folder) {
  std::vector<const CodeInput*> all;
  for (const CodeInput& f : folder.functions)
    if (f.scene.batch) all.push_back(&f);
  return all;
}

// What tells a function's rollouts what an impact does, where the scene asks for it: the function itself, or another of the
// folder that takes no more than it does.
const CodeInput* impact_of(const Folder& folder, const CodeInput& code) {
  const auto tells = [](const CodeInput& f) { return !function_of(f).impact_result().empty(); };
  if (!code.scene.impacts) return nullptr;
  if (tells(code)) return &code;
  for (const CodeInput& f : folder.functions)
    if (tells(f) && (!*function_of(f).input() || function_of(f).inputs == function_of(code).inputs)) return &f;
  return nullptr;
}

}  // namespace

std::vector<std::string> functions_in_lanes(const Folder& folder) {
  std::vector<std::string> names;
  for (const CodeInput* f : batched(folder)) {
    const BatchProgram program(*f);
    if (program.elements() > BatchFunction::most_elements) return {};
    if (!program.by_calls()) names.push_back(function_of(*f).name);
  }
  return names;
}

std::string batch_c_declarations(const Folder& folder) {
  if (batched(folder).empty()) return "";
  const CodeInput& code = folder.common();
  const std::string n = code.name, s = scalar_name(code.scene.scalar);
  std::string given;
  for (const RunTimeInput& g : ir::run_time_inputs(code.scene))
    given += fmt::format("  const {}* {};  // {}\n", s, g.each, comment_of_each(g));
  if (reads_workspace(code))
    given =
        fmt::format(
            "  // Run-time inputs: those of the workspace for all states, NULL: those of a new one; or, where they are not\n"
            "  // NULL, one per state, laid out as states are: in rows, or in lanes.\n"
            "  const {}_workspace* workspace;\n",
            n) +
        given;
  for (const CodeInput* f : batched(folder))
    if (BatchFunction(*f, impact_of(folder, *f)).has_impacts()) {
      given += fmt::format(
          "  // Of rollouts: which contacts and loops act in each step, 1 or 0 each; NULL: as in the workspace.\n"
          "  const {}* active;\n",
          s);
      break;
    }
  std::string text = fmt::format(
      "// Many states at once. Numbers of states and results stand one after another, unless options say otherwise.\n"
      "typedef struct {0}_batch_options {{\n"
      "  int states_in_lanes, results_in_lanes;  // 1: in blocks of {1} states, as dalembert::BatchLayout::lanes\n"
      "  int matrices;                           // 0: row by row, 1: column by column, 2: packed, as in batch.hpp\n"
      "{2}}} {0}_batch_options;\n\n"
      "// What a number that a function of batches returns means.\n"
      "const char* {0}_batch_error(int error);\n\n",
      n, code.scene.scalar == ir::ScalarType::float32 ? 16 : 8, given);
  for (const CodeInput* f : batched(folder)) text += BatchFunction(*f, impact_of(folder, *f)).c_declarations();
  return text;
}

std::vector<OutputFile> batch_files(const Folder& folder, const std::string& banner) {
  if (batched(folder).empty()) return {};
  const CodeInput& code = folder.common();
  std::string declarations, definitions, c_functions, tasks;
  std::size_t bytes = 0;
  bool rolls_out = false;
  for (const CodeInput* f : batched(folder)) {
    const BatchFunction function(*f, impact_of(folder, *f));
    if (function.elements() > BatchFunction::most_elements)
      throw InputError({Severity::error, "", "key 'batch'",
                        fmt::format("the results of {}() are {} numbers a state, and batches take no more than {}",
                                    function_of(*f).name, function.elements(), BatchFunction::most_elements),
                        "call the function state by state, which takes no longer on a robot of that size, or ask for less"});
    if (code.scene.linearly_implicit && function.rolls_out() && !function.has_implicit_steps())
      throw InputError({Severity::error, "", "key 'rollouts'",
                        fmt::format("a linearly implicit step of {}() is too long to be written out for a robot of that size",
                                    function_of(*f).name),
                        "leave linearly_implicit out, and integrate single states (docs/integrators.md)"});
    declarations += function.header();
    definitions += function.source();
    c_functions += function.c_definitions();
    tasks += function.tasks();
    rolls_out |= function.rolls_out();
    bytes = std::max(bytes, function.bytes() + (function.has_workspace() ? workspace_bytes(folder) : 0));
  }
  // Compilers keep more on the stack than blocks, up to a tenth and 8 kB of it as measured.
  return {{"batch.hpp", render("batch.hpp", {{"banner", banner},
                                             {"name", code.name},
                                             {"code", code_mark},
                                             {"stack", std::to_string((bytes + bytes / 8) / 1024 + 12)},
                                             {"includes", rolls_out ? "#include <dalembert/rollout_layout.hpp>\n" : ""},
                                             {"given", given_members(code)},
                                             {"functions", declarations}})},
          {"batch.cpp", render("batch.cpp", {{"banner", banner},
                                             {"name", code.name},
                                             {"code", code_mark},
                                             {"includes", rolls_out ? "#include <dalembert/rollout.hpp>\n" : ""},
                                             {"functions", definitions},
                                             {"c_functions", c_functions}})},
          {"batch_tasks.hpp",
           render("batch_tasks.hpp", {{"banner", banner}, {"name", code.name}, {"code", code_mark}, {"functions", tasks}})}};
}

}  // namespace dalembert::backend
