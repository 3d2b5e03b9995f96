#include "compile.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "backend/emit.hpp"
#include "passes/normalise.hpp"
#include "passes/plan.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/roll.hpp"
#include "passes/unroll.hpp"
#include "reference/self_test.hpp"
#include "report.hpp"

namespace dalembert {
namespace {

// FNV-1a, 64 bits: tells one URDF from another in the banner; no protection against anyone.
std::string hash_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (std::istreambuf_iterator<char> at(file), end; at != end; ++at)
    hash = (hash ^ static_cast<unsigned char>(*at)) * 0x100000001b3ull;
  return fmt::format("{:016x}", hash);
}

// All but the URDF's hash, the report and the self-test.
backend::CodeInput code_input(const Model& model, const Lowered& lowered) {
  return {model.tree,
          lowered.normal,
          model.scene,
          lowered.algorithm,
          lowered.program,
          lowered.plan,
          lowered.rolled,
          model.name,
          std::filesystem::path(model.description.file).filename().string(),
          "",
          model.command_line,
          {},
          {}};
}

std::vector<backend::OutputFile> emit(const Model& model, std::optional<ir::SelfTest> self_test) {
  const Lowered lowered = lower(model);
  backend::CodeInput code = code_input(model, lowered);
  code.source_hash = hash_of_file(model.description.file);
  code.report = report(model, lowered);
  code.self_test = std::move(self_test);
  return backend::emit(code);
}

}  // namespace

Lowered lower(const Model& model) {
  const ir::Graph::Options options{model.options.fold, model.options.share};
  Lowered lowered;
  lowered.normal = passes::normalise(model.tree, passes::normalise_options(model.scene, model.options.move_parameters));
  lowered.algorithm = passes::describe(model.tree, lowered.normal, model.scene, options);
  const bool names = model.tree.joints() < 200;  // nobody reads a straight line of a million statements
  passes::Unroll unroll(lowered.algorithm, model.tree, lowered.normal, model.scene, {options, names});
  const ir::Program& program = unroll.program();
  const ir::Operations operations = ir::count(program.graph, ir::uses(program.graph, program.roots()));
  lowered.plan = passes::plan(model.tree, model.scene, operations, model.options);
  if (lowered.plan.form == ir::Form::rolled)
    lowered.rolled = passes::roll(lowered.algorithm, unroll, model.tree, model.scene, lowered.plan, options);
  lowered.program = unroll.take_program();
  return lowered;
}

std::size_t workspace_bytes(const Model& model, const Lowered& lowered) {
  return backend::workspace_bytes(code_input(model, lowered));
}

std::vector<backend::OutputFile> compile(const Model& model) {
  return emit(model, reference::self_test(model.tree, model.scene));
}

std::vector<backend::OutputFile> compile_without_self_test(const Model& model) { return emit(model, std::nullopt); }

}  // namespace dalembert
