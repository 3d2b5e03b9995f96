#include "commands/build/table_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "backend/templates.hpp"
#include "ir/identifier.hpp"
#include "ir/run_time_inputs.hpp"

namespace dalembert {

namespace {

std::string set_run_time_inputs(const Model& model) {
  std::string text;
  int at = 0;
  for (const ir::RunTimeInput& input : ir::run_time_inputs(model.scene))
    for (const ir::RunTimeInput::Member& member : input.members) {
      if (member.flag) text += fmt::format("    workspace.{} = values[{}] > 0;\n", member.name, at);
      else if (member.size == 0) text += fmt::format("    workspace.{} = values[{}];\n", member.name, at);
      else
        text += fmt::format("    for (int i = 0; i < {1}; ++i) workspace.{0}[i] = values[{2} + i];\n", member.name, member.size,
                            at);
      at += member.count();
    }
  return text;
}

// A status in the workspace, where it has one of that name.
std::string status_reader(const char* reader, const std::string& member) {
  return fmt::format(
      "  template <class W>\n"
      "  static auto {0}(const W& workspace, int) noexcept -> decltype((workspace.{1})) {{\n    return workspace.{1};\n  }}\n"
      "  template <class W>\n"
      "  static dalembert::table::NoStatus {0}(const W&, long) noexcept {{\n    return {{}};\n  }}\n",
      reader, member);
}

std::string status_readers(const ir::EmittedFunction& function) {
  std::string text;
  for (const auto& [reader, member] : {std::pair{"of_mass_matrix", "status"},
                                       {"of_linkages", "linkage_status"},
                                       {"of_constraints", "constraint_status"},
                                       {"of_impact", "impact_status"},
                                       {"of_support", "support_status"}})
    text += status_reader(reader, function.own_name(member));
  return text;
}

// A class of what dalembert/function_table.hpp calls.
std::string table_class(const Library& library, size_t index) {
  const TableFunction& f = library.functions[index];
  const Model& model = library.parts[f.part].model;
  const bool takes_more = *f.function.input() != 0;
  int inputs = 0;
  for (const ir::RunTimeInput& input : ir::run_time_inputs(model.scene)) inputs += input.size();
  const std::string set = set_run_time_inputs(model);
  std::string copies;
  for (size_t i = 0; i < f.results.size(); ++i)
    copies += fmt::format("    dalembert::table::copy_result<{}, {}>(workspace.{}, results[{}], state);\n", f.results[i].rows,
                          f.results[i].columns, f.results[i].name, i);
  return fmt::format(
      "struct Function{0} {{\n"
      "  using Scalar = {1}::Scalar;\n"
      "  using Workspace = {1}::Workspace;\n"
      "  static constexpr int run_time_inputs = {2};\n"
      "  static void set([[maybe_unused]] const Scalar* values, [[maybe_unused]] Workspace& workspace) noexcept {{\n{3}  }}\n"
      "  static void call(const Scalar* q, const Scalar* v, [[maybe_unused]] const Scalar* more, Workspace& workspace) "
      "noexcept {{\n"
      "    {1}::{4}(q, v{5}, workspace);\n  }}\n"
      "  static void copy(const Workspace& workspace, void* const* results, std::ptrdiff_t state) noexcept {{\n{6}  }}\n"
      "  static constexpr int nv = {1}::nv;\n"
      "{7}"
      "}};\n\n",
      index, model.name, inputs, set, f.function.name, takes_more ? ", more" : "", copies, status_readers(f.function));
}

// The same of a function's batches.
std::string batch_class(const Library& library, size_t index) {
  const TableFunction& f = library.functions[index];
  const Model& model = library.parts[f.part].model;
  const std::string name = model.name;
  const std::vector<ir::RunTimeInput> inputs = ir::run_time_inputs(model.scene);
  int given = 0;
  std::string each, pointers;
  for (const ir::RunTimeInput& input : inputs) {
    each += fmt::format(
        "    batch.{} = dalembert::table::gathered(from + {}, step, {}, n, room + {} * dalembert::table::states_together);\n",
        input.each, given, input.size(), given);
    given += input.size();
  }
  for (size_t i = 0; i < f.results.size(); ++i)
    pointers += fmt::format("    into.{} = static_cast<Scalar*>(results[{}]) + state * {};\n", f.results[i].name, i,
                            f.results[i].rows * f.results[i].columns);
  return fmt::format(
      "struct Batch{0} {{\n"
      "  using Scalar = {1}::Scalar;\n"
      "  using Workspace = {1}::Workspace;\n"
      "  using Batch = {1}::Batch;\n"
      "  static constexpr int nq = {1}::nq, nv = {1}::nv, more = {2}, run_time_inputs = {3};\n"
      "  static constexpr bool reads_v = {4};\n"
      "  static void set([[maybe_unused]] const Scalar* values, [[maybe_unused]] Workspace& workspace) noexcept {{\n{5}  }}\n"
      "  static void set_all([[maybe_unused]] const Workspace& workspace, [[maybe_unused]] Batch& batch) noexcept {{\n{6}  }}\n"
      "  static void set_each([[maybe_unused]] const Scalar* from, [[maybe_unused]] std::ptrdiff_t step,\n"
      "                       [[maybe_unused]] std::ptrdiff_t n, [[maybe_unused]] Scalar* room, [[maybe_unused]] Batch& batch) "
      "noexcept {{\n{7}  }}\n"
      "  using Results = {1}::{8}BatchResults;\n"
      "  template <class R>\n"
      "  static auto put_status(R& into, std::int32_t* status, int) noexcept -> decltype(static_cast<void>(into.status)) {{\n"
      "    into.status = status;\n  }}\n"
      "  template <class R>\n"
      "  static void put_status(R&, std::int32_t*, long) noexcept {{}}\n"
      "  template <class R>\n"
      "  static constexpr auto tells(int) noexcept -> decltype(sizeof(static_cast<R*>(nullptr)->status) > 0) {{\n"
      "    return true;\n  }}\n"
      "  template <class R>\n"
      "  static constexpr bool tells(long) noexcept {{\n    return false;\n  }}\n"
      "  static constexpr bool has_status() noexcept {{ return tells<Results>(0); }}\n"
      "  static bool call(const Batch& batch, void* const* results, std::ptrdiff_t state, std::int32_t* status) noexcept {{\n"
      "    Results into;\n{9}    put_status(into, status, 0);\n"
      "    return {1}::{10}_batch(batch, into, 0, batch.count) == dalembert::BatchError::none;\n  }}\n{11}"
      // That v may be left out where the function does not read it.
      "  static bool self_test(dalembert::SelfTestReport* report) noexcept {{\n"
      "    const Scalar numbers[nq + nv + 1] = {{}};\n"
      "    Batch batch;\n"
      "    batch.count = 1, batch.q = numbers, batch.v = reads_v ? numbers : nullptr, batch.input = numbers;\n"
      "    return {1}::{10}_batch(batch, Results(), 0, 1) == dalembert::BatchError::none && {1}::self_test(report);\n  }}\n"
      "}};\n\n",
      index, name, *f.function.input() ? name + "::nv" : "0", given, f.reads_velocities, set_run_time_inputs(model),
      inputs.empty() ? "" : "    batch.workspace = &workspace;\n", each, f.function.type, pointers, f.function.name,
      acceleration_of(f) < 0
          ? ""
          : fmt::format("  static bool roll_out(const Batch& batch, const dalembert::Rollout<Scalar>& rollout) "
                        "noexcept {{\n"
                        "    return {0}::{1}_rollout(batch, rollout, 0, batch.count) == "
                        "dalembert::BatchError::none;\n  }}\n",
                        name, f.function.name));
}

}  // namespace

std::string table_source(const Library& library) {
  std::string includes, functions, entries;
  for (const Part& part : library.parts)
    includes += fmt::format("#include \"{0}/dynamics.hpp\"\n#include \"{0}/self_test.hpp\"\n", part.model.name);
  for (size_t i = 0; i < library.functions.size(); ++i) {
    const TableFunction& f = library.functions[i];
    functions += table_class(library, i);
    entries += fmt::format("    dalembert::table::entry<Function{}>(\"{}\", {}, {}::self_test),\n", i, table_name(f),
                           f.results.size(), library.parts[f.part].model.name);
  }
  const Model& whole = library.parts.front().model;
  std::string closing;
  if (!whole.tree.linkages.empty())
    closing = fmt::format(
        "void close_loops(void* q, std::ptrdiff_t count, double* status) noexcept {{\n"
        "  dalembert::table::close_rows<{0}::nq, {0}::Scalar>({0}::close_loops, q, count, status);\n}}\n",
        whole.name);
  return backend::render("function_table.cpp", {{"name", library.parts.front().model.name},
                                                {"includes", includes},
                                                {"functions", functions},
                                                {"closing", closing},
                                                {"entries", entries},
                                                {"count", std::to_string(library.functions.size())},
                                                {"close_loops", closing.empty() ? "nullptr" : "close_loops"}});
}

std::string batch_table_source(const Library& library, const std::vector<size_t>& functions) {
  const std::string name = library.parts[library.functions[functions.front()].part].model.name;
  std::string classes, entries;
  for (const size_t f : functions) {
    classes += batch_class(library, f);
    entries += fmt::format("    dalembert::table::batch_entry<Batch{0}>(\"{1}\", {2}, Batch{0}::self_test),\n", f,
                           table_name(library.functions[f]), library.functions[f].results.size());
  }
  return backend::render("function_table.cpp",
                         {{"name", name},
                          {"includes", fmt::format("#include \"{0}/batch.hpp\"\n#include \"{0}/self_test.hpp\"\n", name)},
                          {"functions", classes},
                          {"closing", ""},
                          {"entries", entries},
                          {"count", std::to_string(functions.size())},
                          {"close_loops", "nullptr"}});
}

}  // namespace dalembert
