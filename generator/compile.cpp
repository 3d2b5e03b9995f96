#include "compile.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "backend/code_text.hpp"
#include "backend/emit.hpp"
#include "passes/lower.hpp"
#include "passes/lower_rolled.hpp"
#include "passes/normalise.hpp"
#include "passes/plan.hpp"

namespace dalembert {
namespace {

struct Lowered {
  ir::NormalTree normal;
  ir::Program program;
};

Lowered lower(const Model& model) {
  Lowered lowered{passes::normalise(model.tree, {model.options.move_parameters}), {}};
  lowered.program = passes::lower(model.tree, lowered.normal, model.scene, {{model.options.fold, model.options.share}, true});
  return lowered;
}

// The cost of one result of the program, or of all (-1).
OperationCost cost_of(const ir::Program& program, int array) {
  ir::Program part = {program.graph, program.base_positions, program.arrays, {}, {}};
  for (const ir::OutputElement& e : program.elements)
    if (array < 0 || e.array == array) part.elements.push_back(e);
  const backend::InputsRead read = backend::inputs_read(part);
  return {array < 0 ? "all" : program.arrays[static_cast<size_t>(array)].name,
          ir::count(part.graph, ir::uses(part.graph, part.roots())), read.position, read.velocity, read.base_pose};
}

std::vector<OperationCost> costs_of(const ir::Program& program) {
  std::vector<OperationCost> costs{cost_of(program, -1)};
  for (size_t a = 0; a < program.arrays.size(); ++a) costs.push_back(cost_of(program, static_cast<int>(a)));
  return costs;
}

// FNV-1a, 64 bits: tells one URDF from another in the banner; no protection against anyone.
std::string hash_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (std::istreambuf_iterator<char> at(file), end; at != end; ++at)
    hash = (hash ^ static_cast<unsigned char>(*at)) * 0x100000001b3ull;
  return fmt::format("{:016x}", hash);
}

std::vector<std::string> report(const std::vector<OperationCost>& costs) {
  std::vector<std::string> lines{
      fmt::format("{:<24}{:>10}{:>10}{:>8}{:>8}", "scalar operations", "add", "multiply", "divide", "sincos")};
  for (const OperationCost& c : costs)
    lines.push_back(fmt::format("{:<24}{:>10}{:>10}{:>8}{:>8}", c.name == "all" ? "all together" : c.name, c.operations.add,
                                c.operations.multiply, c.operations.divide, c.operations.sincos));
  return lines;
}

}  // namespace

std::vector<OperationCost> operation_costs(const Model& model) {
  return costs_of(lower(model).program);
}

std::vector<backend::OutputFile> compile(const Model& model) {
  const Lowered lowered = lower(model);
  const std::vector<OperationCost> costs = costs_of(lowered.program);
  const ir::Plan plan = passes::plan(model.tree, model.scene, costs.front().operations, model.options);
  const ir::RolledProgram rolled = plan.form == ir::Form::rolled
                                       ? passes::lower_rolled(model.tree, lowered.normal, model.scene, plan)
                                       : ir::RolledProgram{};
  return backend::emit({model.tree, lowered.normal, model.scene, lowered.program, plan, rolled, model.name,
                        std::filesystem::path(model.description.file).filename().string(),
                        hash_of_file(model.description.file), model.command_line, report(costs)});
}

}  // namespace dalembert
