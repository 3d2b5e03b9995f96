#include "backend/batch_function.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "backend/code_text.hpp"
#include "backend/literals.hpp"
#include "backend/templates.hpp"
#include "dalembert/batch_layout.hpp"
#include "ir/run_time_inputs.hpp"

namespace dalembert::backend {
namespace {

using ir::RunTimeInput;

// Declares `of_all`, what all states have of an input, from `batch`.
std::string of_all(const RunTimeInput& input, const ir::Scene& scene) {
  std::vector<std::string> numbers;
  if (input.type.empty()) {
    for (const double x : input.start) numbers.push_back(literal(x, scene.scalar));
    return fmt::format(
        "      const Scalar usual[] = {{{}}};\n"
        "      const Scalar* const of_all = batch.workspace ? batch.workspace->{} : usual;\n",
        fmt::join(numbers, ", "), input.name);
  }
  for (const RunTimeInput::Member& member : input.members) {
    const std::string own = "of_each." + member.name.substr(input.name.size() + 1);
    if (member.size == 0) numbers.push_back(member.flag ? "Scalar(" + own + ")" : own);
    for (int i = 0; i < member.size; ++i) numbers.push_back(fmt::format("{}[{}]", own, i));
  }
  return fmt::format(
      "      const {0} of_each = batch.workspace ? batch.workspace->{1} : {0}{{}};\n"
      "      const Scalar of_all[] = {{{2}}};\n",
      input.type, input.name, wrapped(numbers, 31));
}

bool is_matrix(const BatchArray& a) { return a.array.columns > 1; }

std::string matrix_name(const BatchArray& a) { return a.array.name + "_of_batch"; }

std::string packed_table(const BatchArray& a) {
  std::vector<std::string> items;
  for (const auto& [row, column] : a.packed) items.push_back(fmt::format("{{{}, {}}}", row, column));
  if (items.empty()) items.emplace_back("{-1, -1}");  // C++ has no empty arrays
  return fmt::format(
      "// Row and column of each element of {0} that stands in it packed{1}.\n"
      "inline constexpr int {0}_packed_size = {2};\n"
      "inline constexpr dalembert::MatrixPlace {0}_packed[] = {{\n    {3}}};\n\n",
      a.array.name, a.symmetric ? ": on and below the diagonal, the matrix being symmetric" : "", a.packed.size(),
      wrapped(items, 4));
}

// A function of its own.
std::string part(const std::string& name, const std::string& statements) {
  const bool used = statements.find("block.") != std::string::npos;
  return fmt::format("  DALEMBERT_STRAIGHT_LINE __attribute__((noinline)) static void {}(Block& {}) noexcept {{\n{}  }}\n",
                     name, used ? "block" : "", statements);
}

}  // namespace

bool reads_workspace(const CodeInput& code) { return !ir::run_time_inputs(code.scene).empty(); }

// Impacts are computed by a call of their function, which takes all that there is.
BatchFunction::BatchFunction(const CodeInput& code, const CodeInput* impact)
    : code_(code), impact_(impact), program_(code, impact && function_of(code).moves_as_held()) {
  if (code.implicit && rolls_out()) implicit_.emplace(code, code.implicit);
}

std::string BatchFunction::header() const {
  std::string pointers, blocks, packed;
  for (const BatchArray& a : program_.results()) {
    pointers += fmt::format("  Scalar* {} = nullptr;  // {}\n", a.array.name, shape(a));
    blocks += fmt::format("  const Scalar* {};\n", a.array.name);
    if (is_matrix(a)) packed += packed_table(a);
  }
  if (code_.algorithm.guard) {
    pointers +=
        "  int* status = nullptr;  // of each state: the coordinate as in FactorStatus, -1 where M is positive definite\n";
    blocks += "  const int* status;  // without stride\n";
  }
  const ir::EmittedFunction& f = function_of(code_);
  return render("batch_function.hpp",
                {{"function", f.name},
                 {"type", f.type},
                 {"pointers", pointers},
                 {"blocks", blocks},
                 {"packed", packed},
                 {"input", *f.input() ? fmt::format(", `input` being {}: {}", f.input(), f.meaning()) : ""},
                 {"rollout", rolls_out() ? render("rollout.hpp", {{"function", f.name}}) : ""}});
}

std::string BatchFunction::source() const {
  const ir::EmittedFunction& f = function_of(code_);
  std::string definitions, run;
  write_program(run, definitions);
  return render(
      "batch_function.cpp",
      {{"function", f.name},
       {"type", f.type},
       {"check", own_name(code_, "check_batch")},
       {"how", program_.by_calls()    ? ", called for one after another"
               : program_.parts() > 1 ? fmt::format(": {} operations in {} parts", program_.operations(), program_.parts())
                                      : fmt::format(": {} operations", program_.operations())},
       {"workspace", program_.by_calls() ? "  Workspace workspace;\n" : ""},
       {"more_members", program_.by_calls() ? ", {}" : ""},
       {"run_is", program_.by_calls() ? "" : "static "},
       {"more", *f.input() ? "nv" : "0"},
       {"given", std::to_string(program_.given_count())},
       {"angles", std::to_string(program_.angles())},
       {"kept", std::to_string(program_.kept())},
       {"elements", std::to_string(program_.elements())},
       {"parts", std::to_string(program_.parts())},
       {"widest", std::to_string(widest())},
       {"fill", fill()},
       {"with_given", with_given(program_)},
       {"run", run},
       {"definitions", definitions},
       {"tables", tables()},
       {"checks", checks()},
       {"finish", finish()},
       {"write", write()},
       {"block", block()},
       {"rollout", rollout()}});
}

std::string BatchFunction::tasks() const {
  const ir::EmittedFunction& f = function_of(code_);
  // A register of four states takes half a cycle for an operation, of 4 GHz: 32 operations of a state are a nanosecond.
  const long wanted = 20000L * 32 / std::max(1L, program_.operations());
  long together = 64;
  while (2 * together <= wanted && together < 4096) together *= 2;
  return render("batch_tasks_function.hpp",
                {{"function", f.name},
                 {"type", f.type},
                 {"together", std::to_string(together)},
                 {"rollout", rolls_out() ? render("rollout_tasks.hpp", {{"function", f.name}}) : ""}});
}

std::size_t BatchFunction::bytes() const { return implicit_ ? std::max(bytes(program_), bytes(*implicit_)) : bytes(program_); }

std::size_t BatchFunction::bytes(const BatchProgram& program) const {
  const int given = program.given_count() + (&program == &program_ ? 0 : implicit_numbers()) + constraint_count();
  const std::size_t registers = static_cast<std::size_t>(code_.robot->nq() + 2 * code_.robot->nv() + given +
                                                         3 * program.angles() + program.kept() + program.elements() + 1);
  std::size_t moving = rolls_out() ? static_cast<std::size_t>(2 * code_.robot->nq() + 7 * code_.robot->nv()) : 0;
  if (has_impacts()) moving += static_cast<std::size_t>(code_.robot->nv() + constraint_count());
  std::size_t most = 0;  // narrow registers make smaller blocks, of which more are a strip
  for (const std::size_t size : {8, 16, 32, 64})
    most =
        std::max(most, (registers + moving) * size * static_cast<std::size_t>(batch_strip(registers * size, program.parts())));
  return most;
}

std::string BatchFunction::shape(const BatchArray& a) {
  return is_matrix(a) ? fmt::format("{} x {}; packed: {} numbers", a.array.rows, a.array.columns, a.packed.size())
                      : std::to_string(a.array.rows);
}

void BatchFunction::write_program(std::string& run, std::string& definitions) const {
  if (program_.by_calls()) {
    run += "    for (int i = 0; i < count; ++i) call_for_each(blocks[i]);\n";
    definitions += calls();
    return;
  }
  straight(program_, run, definitions);
  if (program_.checked().size() == 2) definitions += status();
}

void BatchFunction::straight(const BatchProgram& program, std::string& run, std::string& definitions) {
  if (const std::string angles = program.angle_statements(); !angles.empty()) {
    definitions += part("angles", angles);
    run += "    for (int i = 0; i < count; ++i) angles(blocks[i]);\n";
  }
  if (program.angles() > 0)
    run += fmt::format(
        "    for (int i = 0; i < count; ++i)\n"
        "      dalembert::batch_sincos<Scalar>(blocks[i].angle, {}, blocks[i].sine, blocks[i].cosine);\n",
        program.angles());
  for (int i = 0; i < program.parts(); ++i) {
    definitions += part(fmt::format("part_{}", i), program.part_statements(i));
    run += fmt::format("    for (int i = 0; i < count; ++i) part_{}(blocks[i]);\n", i);
  }
}

std::string BatchFunction::call(const CodeInput& called) const {
  std::string text =
      "      Scalar q[nq], v[nv];\n"
      "      dalembert::take_state<Scalar>(block.q, nq, state, q);\n"
      "      dalembert::take_state<Scalar>(block.v, nv, state, v);\n";
  const std::vector<std::string> vectors = vectors_of(called);
  if (vectors.size() > 2)
    text += fmt::format(
        "      Scalar {0}[nv];\n"
        "      dalembert::take_state<Scalar>(block.input, nv, state, {0});\n",
        vectors[2]);
  int at = 0;
  for (const RunTimeInput& input : program_.given())
    for (const RunTimeInput::Member& member : input.members) {
      if (member.flag)
        text += fmt::format("      workspace.{} = dalembert::lane<width, Scalar>(block.given[{}], state) > Scalar(0);\n",
                            member.name, at);
      else
        text += fmt::format("      dalembert::take_state<Scalar>(block.given + {}, {}, state, {}workspace.{});\n", at,
                            member.count(), member.size > 0 ? "" : "&", member.name);
      at += member.count();
    }
  return text + fmt::format("      {}({}, workspace);\n", function_of(called).name, arguments_of(called));
}

std::string BatchFunction::status() const {
  return "\n  // Of states whose pivots are small: the function itself tells.\n"
         "  __attribute__((noinline)) static void find_status(Block& block) noexcept {\n"
         "    Workspace workspace;\n"
         "    for (int state = 0; state < width; ++state) {\n"
         "      if (block.status[state] < 0) continue;\n" +
         call(code_) + fmt::format("      block.status[state] = workspace.{}.coordinate;\n", own_name(code_, "status")) +
         "    }\n  }\n";
}

std::string BatchFunction::calls() const {
  std::string text =
      "  void call_for_each(Block& block) noexcept {\n"
      "    for (int state = 0; state < block.states; ++state) {\n" +
      call(code_);
  for (const BatchArray& a : program_.results()) {
    // Packed is row by row, and the workspace has columns.
    if (!is_matrix(a))
      text += fmt::format("      dalembert::put_state<Scalar>(workspace.{}, {}, state, block.values + {});\n", a.array.name,
                          a.array.rows, a.first);
    else
      text += fmt::format(
          "      for (int row = 0; row < {1}; ++row)\n"
          "        for (int column = 0; column < {2}; ++column)\n"
          "          dalembert::put_state<Scalar>(workspace.{0} + row + {1} * column, 1, state,\n"
          "                                       block.values + {3} + {2} * row + column);\n",
          a.array.name, a.array.rows, a.array.columns, a.first);
  }
  if (code_.algorithm.guard)
    text += fmt::format("      block.status[state] = workspace.{}.coordinate;\n", own_name(code_, "status"));
  return text + "    }\n  }\n";
}

std::string BatchFunction::fill() const {
  std::string text;
  const auto read = [&](const char* member, const char* count, bool needed) {
    if (needed)
      text += fmt::format("    dalembert::read_states<{1}, Scalar>(batch.{0}, batch.states, first, states, block.{0});\n",
                          member, count);
  };
  read("q", "nq", program_.reads_positions());
  read("v", "nv", program_.reads_velocities());
  read("input", "nv", program_.reads_input());
  return text;
}

std::string BatchFunction::with_given(const BatchProgram& program) const {
  std::string text;
  int at = 0;
  for (const RunTimeInput& g : program.given()) {
    text += fmt::format(
        "    {{\n{}      dalembert::read_given<{}, Scalar>(batch.{}, of_all, batch.states, first, states, block.given + "
        "{});\n"
        "    }}\n",
        of_all(g, code_.scene), g.size(), g.each, at);
    at += g.size();
  }
  return text.empty() ? "    (void)block, (void)first, (void)states;\n" : text;
}

std::string BatchFunction::checks() const {
  std::string text;
  const auto check = [&](const char* member, bool needed) {
    if (needed) text += fmt::format("  if (batch.count > 0 && !batch.{0}) return dalembert::BatchError::{0};\n", member);
  };
  check("q", program_.reads_positions());
  check("v", program_.reads_velocities());
  check("input", program_.reads_input());
  return text;
}

int BatchFunction::widest() const {
  int widest = std::max({code_.robot->nq(), 10});
  for (const BatchArray& a : program_.results()) widest = std::max(widest, a.array.rows * a.array.columns);
  return widest;
}

std::string BatchFunction::tables() const {
  std::string text;
  for (const BatchArray& a : program_.results()) {
    const int whole = a.array.rows * a.array.columns;
    std::string by_rows = "nullptr", by_columns = "nullptr";
    if (is_matrix(a)) {
      const auto table = [&](const std::string& name, const std::vector<int>& places) {
        std::vector<std::string> items;
        for (const int place : places) items.push_back(std::to_string(place < 0 ? program_.elements() : place));
        text += fmt::format("constexpr std::uint16_t {}[] = {{\n    {}}};\n", name, wrapped(items, 4));
        return name;
      };
      by_rows = by_columns = table(matrix_name(a) + "_by_rows", a.by_rows());
      if (!a.symmetric) by_columns = table(matrix_name(a) + "_by_columns", a.by_columns);
    }
    text += fmt::format("constexpr dalembert::BatchMatrix {}{{{}, {}, {}, {}, {}}};\n", matrix_name(a), a.first,
                        a.packed.size(), whole, by_rows, by_columns);
  }
  return text;
}

std::string BatchFunction::finish() const {
  const auto& checked = program_.checked();
  if (checked.size() < 2) return "";
  std::string text = fmt::format(
      "    if (!dalembert::batch_holds<nv, Scalar>(block.values + {}, block.values + {}, block.status)) {{\n"
      "      Program::find_status(block);\n",
      checked[0].first, checked[1].first);
  for (const BatchArray& a : program_.results())
    if (a.cleared)
      text +=
          fmt::format("      dalembert::batch_clear<Scalar>(block.status, block.values + {}, {});\n", a.first, a.packed.size());
  return text + "    }\n";
}

std::string BatchFunction::write() const {
  std::string text;
  for (const BatchArray& a : program_.results())
    text += fmt::format(
        "    dalembert::write_matrix<Scalar>(block.values, {}, batch.matrices, batch.results, at, states, results.{});\n",
        matrix_name(a), a.array.name);
  if (code_.algorithm.guard)
    text +=
        "    if (results.status)\n"
        "      for (int i = 0; i < states; ++i) results.status[at + static_cast<std::size_t>(i)] = block.status[i];\n";
  return text;
}

std::string BatchFunction::block() const {
  std::string text;
  for (const BatchArray& a : program_.results())
    text += fmt::format(", reinterpret_cast<const Scalar*>(block.values + {})", a.first);
  return text + (code_.algorithm.guard ? ", block.status" : "");
}

}  // namespace dalembert::backend
