// In C.
#include <fmt/format.h>

#include "backend/batch_function.hpp"
#include "backend/code_text.hpp"
#include "backend/literals.hpp"
#include "ir/run_time_inputs.hpp"

namespace dalembert::backend {

using ir::RunTimeInput;

std::string BatchFunction::c_declarations() const {
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

std::string BatchFunction::c_definitions() const {
  const ir::EmittedFunction& f = function_of(code_);
  const std::string n = code_.name, s = scalar_name(code_.scene.scalar);
  std::string fields, given;
  for (const BatchArray& a : program_.results()) fields += fmt::format("    to.{0} = results->{0};\n", a.array.name);
  for (const RunTimeInput& g : ir::run_time_inputs(code_.scene))
    given += fmt::format("    batch.{0} = options->{0};\n", g.each);
  if (reads_workspace(code_)) given = "    batch.workspace = options->workspace;\n" + given;
  return fmt::format(
             "__attribute__((weak)) int {0}_batch_{1}(const {2}* q, const {2}* v, const {2}* input, size_t n,\n"
             "    const {0}_{1}_batch_results* results, int* status, const {0}_batch_options* options) {{\n"
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
             n, f.name, s, given, own_type(code_, "BatchResults"), fields,
             code_.algorithm.guard ? "  to.status = status;\n" : "",
             code_.algorithm.guard ? ""
                                   : "  if (status && error == dalembert::BatchError::none)\n"
                                     "    for (size_t i = 0; i < n; ++i) status[i] = -1;\n") +
         (rolls_out() ? rollout_definition(given) : "");
}

std::string BatchFunction::rollout_declaration() const {
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

std::string BatchFunction::rollout_definition(const std::string& given) const {
  return fmt::format(
      "__attribute__((weak)) int {0}_rollout_{1}(const {2}* q, const {2}* v, const {2}* input, size_t n, size_t steps,\n"
      "    {2} time_step, int method, {2}* last_q, {2}* last_v, {2}* path_q, {2}* path_v, int* stopped,\n"
      "    const {0}_batch_options* options) {{\n"
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
      impact_ ? "  if (options) rollout.active = options->active;\n" : "");  // refused by those that contacts do not hold
}

}  // namespace dalembert::backend
