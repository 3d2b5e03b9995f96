#include "backend/emit_batch.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "backend/batch_program.hpp"
#include "backend/code_text.hpp"
#include "backend/literals.hpp"
#include "backend/templates.hpp"
#include "dalembert/batch_layout.hpp"
#include "diagnostics.hpp"
#include "ir/identifier.hpp"
#include "ir/implicit_joints.hpp"
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
  for (int i = 0; i < input.size(); ++i) numbers.push_back("of_each." + input.element(i).substr(input.name.size() + 1));
  return fmt::format(
      "      const {0} of_each = batch.workspace ? batch.workspace->{1} : {0}{{}};\n"
      "      const Scalar of_all[] = {{{2}}};\n",
      input.type, input.name, wrapped(numbers, 31));
}

// Beside the member of a batch that has one for each state.
std::string comment_of_each(const RunTimeInput& input) {
  std::string text = fmt::format("{} numbers each: {}", input.size(), comment_text(input.meaning));
  if (input.type.empty()) return text;
  std::vector<std::string> members;
  for (const RunTimeInput::Member& member : input.members) members.push_back(member.name.substr(input.name.size() + 1));
  return text + fmt::format(", as a {}: {}", input.type, fmt::join(members, ", "));
}

// Whether anything of a workspace acts on a batch: run-time inputs, and how contacts and loops hold.
bool reads_workspace(const CodeInput& code) { return !ir::run_time_inputs(code.scene).empty(); }

std::string given_members(const CodeInput& code) {
  if (!reads_workspace(code)) return "";
  const std::vector<RunTimeInput> all = ir::inputs_of_each_state(code.scene);
  std::string text =
      all.empty()
          ? "  // How contacts and loops hold: as in this workspace, or without one as in a new workspace.\n"
          : "  // Run-time inputs: those of this workspace for all states, or without one what a new workspace has; or, "
            "where there is a\n"
            "  // pointer, one for each state, laid out as states are.\n";
  text += "  const Workspace* workspace = nullptr;\n";
  for (const RunTimeInput& g : all) text += fmt::format("  const Scalar* {} = nullptr;  // {}\n", g.each, comment_of_each(g));
  return text;
}

std::string results_type(const CodeInput& code, const char* what) { return own_type(code, what); }

bool is_matrix(const BatchArray& a) { return a.array.columns > 1; }

class BatchFunction {
 public:
  // impact: of the folder, the function that tells what an impact does; null: rollouts know none.
  explicit BatchFunction(const CodeInput& code, const CodeInput* impact = nullptr)
      : code_(code), impact_(impact), program_(code) {
    if (code.implicit && rolls_out()) implicit_.emplace(code, code.implicit);
  }

  std::string header() const {
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

  // Whether it tells how a robot moves, so that motions can be computed in one call.
  bool rolls_out() const { return moved_by() != nullptr; }
  // Whether contacts and loops come on and go in its rollouts, with impacts.
  bool has_impacts() const { return impact_ && rolls_out() && function_of(code_).moves_as_held(); }
  // Whether by linearly implicit steps, too.
  bool has_implicit_steps() const { return implicit_.has_value(); }

  std::string source() const {
    const ir::EmittedFunction& f = function_of(code_);
    std::string definitions, run;
    if (program_.by_calls()) {
      run = "    for (int i = 0; i < count; ++i) call_for_each(blocks[i]);\n";
      definitions = calls();
    } else {
      straight(program_, run, definitions);
      if (program_.checked().size() == 2) definitions += status();
    }
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
         {"given", std::to_string(given_count(code_))},
         {"angles", std::to_string(program_.angles())},
         {"kept", std::to_string(program_.kept())},
         {"elements", std::to_string(program_.elements())},
         {"parts", std::to_string(program_.parts())},
         {"widest", std::to_string(widest())},
         {"fill", fill()},
         {"with_given", with_given()},
         {"run", run},
         {"definitions", definitions},
         {"tables", tables()},
         {"checks", checks()},
         {"finish", finish()},
         {"write", write()},
         {"block", block()},
         {"rollout", rollout()}});
  }

  // Whether it calls the function itself.
  bool has_workspace() const { return program_.by_calls() || program_.checked().size() == 2; }
  // Whether a table of places can hold them, and a stack the registers.
  static constexpr int most_elements = 20000;
  int elements() const { return program_.elements(); }

  // In C: what is declared, and what is defined.
  std::string c_declarations() const {
    const ir::EmittedFunction& f = function_of(code_);
    const std::string n = code_.name, s = scalar_name(code_.scene.scalar);
    std::string members;
    for (const BatchArray& a : program_.results()) members += fmt::format("  {}* {};  // {}\n", s, a.array.name, shape(a));
    return fmt::format(
               "// What is computed of each state, one after another: NULL where it is not wanted.\n"
               "typedef struct {0}_{1}_batch_results {{\n{2}}} {0}_{1}_batch_results;\n\n"
               "// {0}_{1}() at n states. q: n times {0}_nq() numbers, v: n times {0}_nv(){3}. status, which may be NULL{4}. "
               "options "
               "may be\n"
               "// NULL. 0, or what is wrong: see {0}_batch_error().\n"
               "int {0}_batch_{1}(const {5}* q, const {5}* v, const {5}* input, size_t n, const {0}_{1}_batch_results* "
               "results,\n"
               "    int* status, const {0}_batch_options* options);\n\n",
               n, f.name, members,
               *f.input() ? fmt::format(", input: {}, n times {}_nv()", f.input(), n) : std::string("; input is not read"),
               code_.algorithm.guard ? ": of each state the coordinate whose pivot shows that M is not positive definite, or -1"
                                     : ", is set to -1 for each state",
               s) +
           (rolls_out() ? rollout_declaration() : "");
  }
  std::string c_definitions() const {
    const ir::EmittedFunction& f = function_of(code_);
    const std::string n = code_.name, s = scalar_name(code_.scene.scalar);
    std::string fields, given;
    for (const BatchArray& a : program_.results()) fields += fmt::format("    to.{0} = results->{0};\n", a.array.name);
    for (const RunTimeInput& g : ir::inputs_of_each_state(code_.scene))
      given += fmt::format("    batch.{0} = options->{0};\n", g.each);
    if (reads_workspace(code_)) given = "    batch.workspace = options->workspace;\n" + given;
    return fmt::format(
               "int {0}_batch_{1}(const {2}* q, const {2}* v, const {2}* input, size_t n, const {0}_{1}_batch_results* "
               "results,\n"
               "    int* status, const {0}_batch_options* options) {{\n"
               "  {0}::Batch batch;\n"
               "  batch.count = n, batch.q = q, batch.v = v, batch.input = input;\n"
               "  if (options) {{\n"
               "    batch.states = static_cast<dalembert::BatchLayout>(options->states_in_lanes);\n"
               "    batch.results = static_cast<dalembert::BatchLayout>(options->results_in_lanes);\n"
               "    batch.matrices = static_cast<dalembert::MatrixLayout>(options->matrices);\n"
               "{3}"
               "  }}\n"
               "  {0}::{4} to;\n"
               "  if (results) {{\n{5}  }}\n{6}"
               "  const dalembert::BatchError error = {0}::{1}_batch(batch, to);\n{7}"
               "  return static_cast<int>(error);\n}}\n\n",
               n, f.name, s, given, results_type(code_, "BatchResults"), fields,
               code_.algorithm.guard ? "  to.status = status;\n" : "",
               code_.algorithm.guard ? ""
                                     : "  if (status && error == dalembert::BatchError::none)\n"
                                       "    for (size_t i = 0; i < n; ++i) status[i] = -1;\n") +
           (rolls_out() ? rollout_definition(given) : "");
  }

  std::string rollout_declaration() const {
    return fmt::format(
        "// n motions that {0}_{1}() makes from q and v on, `steps` steps of time_step seconds each. input: {2}, n times steps "
        "times\n"
        "// {0}_nv() numbers, or NULL: zero. method: 0 semi-implicit Euler, 1 the classical Runge-Kutta method{4}. Results may "
        "be "
        "NULL:\n"
        "// where motions end, where they are behind each step, and of each motion the step that it could not make, or -1.\n"
        "int {0}_rollout_{1}(const {3}* q, const {3}* v, const {3}* input, size_t n, size_t steps, {3} time_step, int method,\n"
        "    {3}* last_q, {3}* last_v, {3}* path_q, {3}* path_v, int* stopped, const {0}_batch_options* options);\n\n",
        code_.name, function_of(code_).name, function_of(code_).input(), scalar_name(code_.scene.scalar),
        has_implicit_steps() ? ", 2 linearly implicit Euler" : "");
  }
  std::string rollout_definition(const std::string& given) const {
    return fmt::format(
        "int {0}_rollout_{1}(const {2}* q, const {2}* v, const {2}* input, size_t n, size_t steps, {2} time_step, int method,\n"
        "    {2}* last_q, {2}* last_v, {2}* path_q, {2}* path_v, int* stopped, const {0}_batch_options* options) {{\n"
        "  {0}::Batch batch;\n"
        "  batch.count = n, batch.q = q, batch.v = v, batch.input = input;\n"
        "  if (options) {{\n"
        "    batch.states = static_cast<dalembert::BatchLayout>(options->states_in_lanes);\n"
        "    batch.results = static_cast<dalembert::BatchLayout>(options->results_in_lanes);\n"
        "{3}  }}\n"
        "  dalembert::Rollout<{2}> rollout;\n"
        "  rollout.steps = steps, rollout.time_step = time_step;\n"
        "  rollout.method = static_cast<dalembert::RolloutMethod>(method);\n"
        "  rollout.last_q = last_q, rollout.last_v = last_v, rollout.path_q = path_q, rollout.path_v = path_v;\n"
        "  rollout.stopped = stopped;\n{4}"
        "  return static_cast<int>({0}::{1}_rollout(batch, rollout));\n}}\n\n",
        code_.name, function_of(code_).name, scalar_name(code_.scene.scalar), given,
        has_impacts() ? "  if (options) rollout.active = options->active;\n" : "");
  }

  // Of a call.
  std::size_t bytes() const { return implicit_ ? std::max(bytes(program_), bytes(*implicit_)) : bytes(program_); }

  // For threads: states that are handed out together, some 20 us of them.
  std::string tasks() const {
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

 private:
  std::size_t bytes(const BatchProgram& program) const {
    const int given = given_count(code_) + (&program == &program_ ? 0 : implicit_numbers()) + constraint_count();
    const std::size_t registers = static_cast<std::size_t>(code_.robot->nq() + 2 * code_.robot->nv() + given +
                                                           3 * program.angles() + program.kept() + program.elements() + 1);
    std::size_t moving = rolls_out() ? static_cast<std::size_t>(2 * code_.robot->nq() + 7 * code_.robot->nv()) : 0;
    if (has_impacts()) moving += static_cast<std::size_t>(code_.robot->nv() + constraint_count());
    std::size_t most = 0;  // narrow registers make smaller blocks, of which more are a strip
    for (const std::size_t size : {8, 16, 32, 64})
      most = std::max(most,
                      (registers + moving) * size * static_cast<std::size_t>(batch_strip(registers * size, program.parts())));
    return most;
  }

  static std::string shape(const BatchArray& a) {
    return is_matrix(a) ? fmt::format("{} x {}; packed: {} numbers", a.array.rows, a.array.columns, a.packed.size())
                        : std::to_string(a.array.rows);
  }

  static std::string packed_table(const BatchArray& a) {
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

  static std::string part(const std::string& name, const std::string& statements) {
    const bool used = statements.find("block.") != std::string::npos;
    return fmt::format("  DALEMBERT_STRAIGHT_LINE __attribute__((noinline)) static void {}(Block& {}) noexcept {{\n{}  }}\n",
                       name, used ? "block" : "", statements);
  }

  static void straight(const BatchProgram& program, std::string& run, std::string& definitions) {
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

  // The function itself at the state `state` of a block, into a `workspace`.
  std::string call() const { return call(code_, false); }
  // Of a function that takes the same, or less; switched: which contacts and loops act stands in the block.
  std::string call(const CodeInput& called, bool switched) const {
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
    for (const RunTimeInput& input : ir::inputs_of_each_state(code_.scene))
      for (const RunTimeInput::Member& member : input.members) {
        text += fmt::format("      dalembert::take_state<Scalar>(block.given + {}, {}, state, {}workspace.{});\n", at,
                            member.count(), member.size > 0 ? "" : "&", member.name);
        at += member.count();
      }
    for (const ir::Constraint& c : code_.scene.constraints()) {
      if (!program_.by_calls()) break;  // what is in lanes reads none
      text += fmt::format("      if (batch.workspace) workspace.{0} = batch.workspace->{0};\n", c.member);
      if (switched)
        text += fmt::format("      workspace.{}.active = dalembert::lane<width, Scalar>(block.given[{}], state) > Scalar(0);\n",
                            c.member, at++);
    }
    return text + fmt::format("      {}({}, workspace);\n", function_of(called).name, arguments_of(called));
  }

  // Near a singular M, by the function itself: states are few, and the bounds that tell are as much work as the rest.
  std::string status() const {
    return "\n  // Of states whose pivots are small: the function itself tells.\n"
           "  __attribute__((noinline)) static void find_status(Block& block) noexcept {\n"
           "    Workspace workspace;\n"
           "    for (int state = 0; state < width; ++state) {\n"
           "      if (block.status[state] < 0) continue;\n" +
           call() + fmt::format("      block.status[state] = workspace.{}.coordinate;\n", own_name(code_, "status")) +
           "    }\n  }\n";
  }

  // The function itself at each state of a block.
  std::string calls(bool switched = false) const {
    std::string text =
        "  void call_for_each(Block& block) noexcept {\n"
        "    for (int state = 0; state < block.states; ++state) {\n" +
        call(code_, switched);
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

  std::string fill() const {
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

  std::string with_given() const {
    std::string text;
    int at = 0;
    for (const RunTimeInput& g : ir::inputs_of_each_state(code_.scene)) {
      text += fmt::format(
          "    {{\n{}      dalembert::read_given<{}, Scalar>(batch.{}, of_all, batch.states, first, states, block.given + "
          "{});\n"
          "    }}\n",
          of_all(g, code_.scene), g.size(), g.each, at);
      at += g.size();
    }
    return text.empty() ? "    (void)block, (void)first, (void)states;\n" : text;
  }

  std::string checks() const {
    std::string text;
    const auto check = [&](const char* member, bool needed) {
      if (needed) text += fmt::format("  if (batch.count > 0 && !batch.{0}) return dalembert::BatchError::{0};\n", member);
    };
    check("q", program_.reads_positions());
    check("v", program_.reads_velocities());
    check("input", program_.reads_input());
    return text;
  }

  int widest() const {
    int widest = std::max({code_.robot->nq(), 10});
    for (const BatchArray& a : program_.results()) widest = std::max(widest, a.array.rows * a.array.columns);
    return widest;
  }

  // v̇ among the values.
  const BatchArray* moved_by() const { return moved_by(program_); }
  const BatchArray* moved_by(const BatchProgram& program) const {
    const std::string name = function_of(code_).acceleration_result();
    const auto& all = program.results();
    const auto found = std::find_if(all.begin(), all.end(), [&](const BatchArray& a) { return a.array.name == name; });
    return name.empty() || found == all.end() ? nullptr : &*found;
  }

  std::string rollout() const {
    const ir::EmittedFunction& f = function_of(code_);
    if (!rolls_out()) return "";
    return render("rollout.cpp", {{"function", f.name},
                                  {"type", f.type},
                                  {"more_members", program_.by_calls() ? ", {}" : ""},
                                  {"moved_by", std::to_string(moved_by()->first)},
                                  {"joints", joints_that_turn()},
                                  {"finish", finish()},
                                  {"generated", implicit_       ? "<true>"
                                                : has_impacts() ? "<false, true>"
                                                                : ""},
                                  {"program", has_impacts() ? "ContactProgram" : "BatchProgram"},
                                  {"other_program", has_impacts() ? contact_program() : implicit_program()},
                                  {"implicit_steps", implicit_steps()}});
  }
  std::string joints_that_turn() const { return code_.robot->any_quaternion() ? ", quaternion_joints" : ""; }

  int implicit_numbers() const {
    return ir::implicit_numbers * static_cast<int>(ir::implicit_joints(code_.implicit->tree).size());
  }

  int constraint_count() const { return has_impacts() ? static_cast<int>(code_.scene.constraints().size()) : 0; }

  std::string contact_program() const {
    const int first = given_count(code_);
    std::string as_set, strike = call(*impact_, true);
    for (size_t line = 0; line < strike.size(); line = strike.find('\n', line) + 1) strike.erase(line, 2);  // in no loop
    int at = first;
    for (const ir::Constraint& c : code_.scene.constraints())
      as_set += fmt::format(
          "    block.given[{}] = dalembert::broadcast<width, Scalar>(!batch.workspace || batch.workspace->{}.active ? 1 : "
          "0);\n",
          at++, c.member);
    return render("rollout_contacts.cpp", {{"function", function_of(code_).name},
                                           {"type", function_of(code_).type},
                                           {"struck_by", function_of(*impact_).name},
                                           {"result", function_of(*impact_).impact_result()},
                                           {"given", std::to_string(at)},
                                           {"first_active", std::to_string(first)},
                                           {"constraints", std::to_string(constraint_count())},
                                           {"elements", std::to_string(program_.elements())},
                                           {"with_given", with_given()},
                                           {"as_set", as_set},
                                           {"strike", strike},
                                           {"definitions", calls(true)}});
  }

  std::string implicit_program() const {
    if (!implicit_) return "";
    std::string run, definitions, constants;
    straight(*implicit_, run, definitions);
    int at = given_count(code_);
    for (const ir::ImplicitJoint& joint : ir::implicit_joints(code_.implicit->tree)) {
      const std::string damping = literal(joint.damping, code_.scene.scalar),
                        stiffness = literal(joint.stiffness, code_.scene.scalar);
      const auto put = [&](int component, const std::string& value) {
        constants += fmt::format("    block.given[{}] = dalembert::broadcast<width, Scalar>({});\n", at + component, value);
      };
      constants += fmt::format("    // {}: h (D + h K){}\n",
                               comment_text(code_.implicit->tree.bodies[static_cast<size_t>(joint.body)].joint),
                               joint.stiffness == 0 ? "" : ", h K");
      put(ir::implicit_inertia,
          joint.stiffness == 0 ? fmt::format("h * {}", damping) : fmt::format("h * ({} + h * {})", damping, stiffness));
      if (joint.stiffness != 0) put(ir::implicit_force, fmt::format("h * {}", stiffness));
      at += ir::implicit_numbers;
    }
    if (constants.empty()) constants = "    (void)h;\n";
    return render("rollout_implicit.cpp", {{"function", function_of(code_).name},
                                           {"type", function_of(code_).type},
                                           {"operations", std::to_string(implicit_->operations())},
                                           {"given", std::to_string(at)},
                                           {"angles", std::to_string(implicit_->angles())},
                                           {"kept", std::to_string(implicit_->kept())},
                                           {"elements", std::to_string(implicit_->elements())},
                                           {"parts", std::to_string(implicit_->parts())},
                                           {"with_given", with_given()},
                                           {"constants", constants},
                                           {"run", run},
                                           {"definitions", definitions}});
  }

  // The motions by such steps: as semi-implicit Euler's, but for v̇.
  std::string implicit_steps() const {
    if (!implicit_) return "";
    const auto& checked = implicit_->checked();
    std::string finish = fmt::format(
        "          if (!dalembert::batch_holds<nv, Scalar>(block.values + {0}, block.values + {1}, block.status)) {{\n"
        "            dalembert::batch_pivots_hold<nv, Scalar>(block.values + {0}, block.values + {1}, block.status);\n",
        checked.at(0).first, checked.at(1).first);
    for (const BatchArray& a : implicit_->results())
      finish += fmt::format("            dalembert::batch_clear<Scalar>(block.status, block.values + {}, {});\n", a.first,
                            a.packed.size());
    return fmt::format(
        "  if (rollout.method == dalembert::RolloutMethod::linearly_implicit) {{\n"
        "    using Program = {}ImplicitProgram;\n"
        "    dalembert::roll_out<nq, nv, Scalar>(\n"
        "        Program{{batch, rollout.time_step}}, rollout, batch.q, batch.v, batch.input, batch.states, batch.results, "
        "first,\n"
        "        first + count, {}, [](Program::Block& block) {{\n{}          }}\n        }}{});\n"
        "    return dalembert::BatchError::none;\n  }}\n",
        function_of(code_).type, moved_by(*implicit_)->first, finish, joints_that_turn());
  }

  static std::string matrix_name(const BatchArray& a) { return a.array.name + "_of_batch"; }

  std::string tables() const {
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

  // Behind the program, for each state.
  std::string finish() const {
    const auto& checked = program_.checked();
    if (checked.size() < 2) return "";
    std::string text = fmt::format(
        "    if (!dalembert::batch_holds<nv, Scalar>(block.values + {}, block.values + {}, block.status)) {{\n"
        "      Program::find_status(block);\n",
        checked[0].first, checked[1].first);
    for (const BatchArray& a : program_.results())
      if (a.cleared)
        text += fmt::format("      dalembert::batch_clear<Scalar>(block.status, block.values + {}, {});\n", a.first,
                            a.packed.size());
    return text + "    }\n";
  }

  std::string write() const {
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

  std::string block() const {
    std::string text;
    for (const BatchArray& a : program_.results())
      text += fmt::format(", reinterpret_cast<const Scalar*>(block.values + {})", a.first);
    return text + (code_.algorithm.guard ? ", block.status" : "");
  }

  const CodeInput& code_;
  const CodeInput* const impact_;
  const BatchProgram program_;
  std::optional<BatchProgram> implicit_;  // of linearly implicit steps
};

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
  for (const RunTimeInput& g : ir::inputs_of_each_state(code.scene))
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
  return {{"batch.hpp", render("batch.hpp", {{"banner", banner},
                                             {"name", code.name},
                                             {"stack", std::to_string(bytes / 1024 + 4)},
                                             {"includes", rolls_out ? "#include <dalembert/rollout_layout.hpp>\n" : ""},
                                             {"given", given_members(code)},
                                             {"functions", declarations}})},
          {"batch.cpp", render("batch.cpp", {{"banner", banner},
                                             {"name", code.name},
                                             {"includes", rolls_out ? "#include <dalembert/rollout.hpp>\n" : ""},
                                             {"functions", definitions},
                                             {"c_functions", c_functions}})},
          {"batch_tasks.hpp", render("batch_tasks.hpp", {{"banner", banner}, {"name", code.name}, {"functions", tasks}})}};
}

}  // namespace dalembert::backend
