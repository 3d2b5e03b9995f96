#include "commands/build/library.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "ir/identifier.hpp"
#include "lower.hpp"

namespace dalembert {

namespace {

std::vector<Output> results_of(const std::vector<Output>& outputs, const ir::EmittedFunction& function) {
  std::vector<Output> results;
  for (const Output& output : outputs)
    if (output.function.name == function.name && output.function.named == function.named) results.push_back(output);
  return results;
}

// What kernels with rows of constraints do with v is theirs, not the program's: those that tell a status solve for what holds.
bool kernels_read_velocities(const ir::Algorithm& algorithm) {
  return std::any_of(algorithm.kernels.begin(), algorithm.kernels.end(),
                     [](const ir::Kernel& kernel) { return *ir::row_of(kernel.kind).status != 0; });
}

}  // namespace

Library library_of(const Model& model, Diagnostics& warnings) {
  Library library;
  if (model.scene.parallel == ir::Parallel::tasks)
    warnings.push_back({Severity::warning, "", "key 'parallel'", "task graphs are left out of what programs load",
                        "give many states at once: they are computed on all cores"});
  const auto add_part = [&](Model part) {
    part.scene.parallel = ir::Parallel::serial;
    library.parts.push_back({std::move(part), {}});
    return library.parts.size() - 1;
  };
  add_part(model);
  const std::vector<Output> outputs = outputs_of(model);
  const std::vector<ir::EmittedFunction> functions = ir::functions_of(model.scene);
  std::vector<TableFunction> alone;
  for (const ir::EmittedFunction& function : functions) {
    const std::vector<Output> results = results_of(outputs, function);
    if (function.named || outputs.size() == 1) {
      library.functions.push_back({0, function, results});
      continue;
    }
    const bool several = results.size() > 1;
    if (several) library.functions.push_back({0, function, results});
    for (const Output& output : results) {
      Model part = with_outputs(model, {output});
      part.scene.batch = false;                                       // the controller's, in the whole scene's folder
      part.name = ir::identifier(output.name) + "_of_" + model.name;  // as no C function of the whole is called
      const ir::EmittedFunction of_one = ir::functions_of(part.scene).front();
      alone.push_back({add_part(std::move(part)), of_one, {output}, several});
    }
  }
  library.functions.insert(library.functions.end(), alone.begin(), alone.end());
  return library;
}

void find_what_is_read(Library& library) {
  for (size_t p = 0; p < library.parts.size(); ++p) {
    std::map<std::string, bool> reads;
    const Lowered lowered = lower_to_programs(library.parts[p].model);
    for (const LoweredFunction& f : lowered.functions)
      for (const LoweredSection& s : f.sections)
        reads[f.name()] |= kernels_read_velocities(s.algorithm) || (s.algorithm.embedding && s.algorithm.embedding->moving) ||
                           !ir::inputs_read(s.program, ir::uses(s.program.graph, s.program.roots())).velocities.empty();
    for (TableFunction& f : library.functions)
      if (f.part == p) f.reads_velocities = reads[f.function.name];
  }
}

std::string table_name(const TableFunction& f) { return f.of_one ? f.results.front().name : f.function.name; }

int acceleration_of(const TableFunction& f) {
  for (const ir::Quantity wanted : {ir::Quantity::constrained_forward_dynamics, ir::Quantity::forward_dynamics})
    for (size_t i = 0; i < f.results.size(); ++i)
      if (f.results[i].quantity == wanted) return static_cast<int>(i);
  return -1;
}

}  // namespace dalembert
