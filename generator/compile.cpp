#include "compile.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <functional>
#include <utility>

#include "backend/code_name.hpp"
#include "backend/code_text.hpp"
#include "backend/emit.hpp"
#include "backend/emit_batch.hpp"
#include "backend/emit_header.hpp"
#include "backend/executed.hpp"
#include "left_out.hpp"
#include "reference/self_test.hpp"

namespace dalembert {
namespace {

backend::Folder folder(const Model& model, const Lowered& lowered) {
  backend::Folder folder;
  // A function, with all that it points to.
  const std::function<backend::CodeInput(const LoweredFunction&, const Model&)> input = [&](const LoweredFunction& f,
                                                                                            const Model& of) {
    const auto section = [&](const LoweredSection& s) {
      return backend::CodeInput{f.part ? f.part->tree : of.tree,
                                f.part ? f.part->normal : lowered.normal,
                                of.scene,
                                s.algorithm,
                                s.program,
                                s.plan,
                                s.rolled,
                                model.name,
                                &of.tree};
    };
    const auto kept = [&](backend::CodeInput code) { return &folder.others.emplace_back(std::move(code)); };
    backend::CodeInput code = section(f.first());
    for (size_t i = f.sections.size(); --i > 0;) {
      backend::CodeInput behind = section(f.sections[i]);
      behind.next = code.next;
      code.next = kept(std::move(behind));
    }
    if (f.batch) code.batch = kept(section(*f.batch));
    if (f.implicit) code.implicit = kept(section(*f.implicit));
    if (f.elsewhere) code.elsewhere = kept(section(*f.elsewhere));
    code.elsewhere_lanes = f.elsewhere_lanes;
    if (!f.opened.empty()) code.opened = kept(input(f.opened.front(), *lowered.opened));
    return code;
  };
  for (const LoweredFunction& f : lowered.functions) folder.functions.push_back(input(f, model));
  folder.source = std::filesystem::path(model.description.files.front()).filename().string();
  folder.command_line = model.command_line;
  return folder;
}

std::vector<backend::OutputFile> emit(const Model& model, std::optional<ir::SelfTest> self_test) {
  Lowered lowered = lower(model);
  decide_tasks(model, lowered);
  backend::Folder code = folder(model, lowered);
  code.source_hash = backend::hash_of(model.description.text);
  code.report = left_out(model, lowered);
  code.self_test = std::move(self_test);
  return backend::emit(code);
}

}  // namespace

std::size_t workspace_bytes(const Model& model, const Lowered& lowered) {
  return backend::workspace_bytes(folder(model, lowered));
}

std::vector<std::pair<std::string, ir::Operations>> executed_operations(const Model& model, const Lowered& lowered) {
  std::vector<std::pair<std::string, ir::Operations>> all;
  for (const backend::CodeInput& code : folder(model, lowered).functions) {
    all.emplace_back(code.algorithm.function.name, ir::Operations());
    for (const backend::CodeInput* section : backend::sections_of(code))
      all.back().second += backend::executed_operations(*section);
  }
  return all;
}

std::vector<std::pair<std::string, backend::Features>> features(const Model& model, const Lowered& lowered, int lanes) {
  std::vector<std::pair<std::string, backend::Features>> all;
  for (const backend::CodeInput& code : folder(model, lowered).functions) {
    all.emplace_back(code.algorithm.function.name, backend::Features{});
    for (const backend::CodeInput* section : backend::sections_of(code)) {
      const backend::Features own = backend::features(*section, lanes);
      for (size_t i = 0; i < own.size(); ++i) all.back().second[i] += own[i];
    }
  }
  return all;
}

void decide_tasks(const Model& model, Lowered& lowered) {
  if (model.scene.parallel == ir::Parallel::serial) return;
  const bool automatic = model.scene.parallel == ir::Parallel::automatic;
  constexpr double too_little = 15000;  // ns: less than threads take to come and to hand over
  const backend::Folder code = folder(model, lowered);
  for (size_t i = 0; i < code.functions.size(); ++i) {
    const backend::CodeInput& f = code.functions[i];
    ir::Plan& plan = lowered.functions[i].sections.front().plan;
    double serial = 0;
    for (const backend::CodeInput* section : backend::sections_of(f))
      serial += backend::estimate(*section, backend::usual_lanes(*section));
    bool pays = f.is_rolled() && !f.elsewhere && (!automatic || serial > too_little);
    plan.sweeps_apart = pays && backend::better_apart(f);  // code sees it
    if (automatic) pays = pays && ir::worth_a_graph(backend::plan_tasks(f));
    plan.sweeps_apart = plan.sweeps_apart && pays;
    for (LoweredSection& section : lowered.functions[i].sections)
      if (automatic) section.plan.tasks = pays;
  }
}

std::vector<FunctionTasks> tasks_of_functions(const Model& model, Lowered lowered) {
  decide_tasks(model, lowered);
  const backend::Folder code = folder(model, lowered);
  std::vector<FunctionTasks> all;
  for (size_t i = 0; i < code.functions.size(); ++i) {
    const backend::CodeInput& f = code.functions[i];
    const bool emitted = f.plan.tasks && f.is_rolled();
    if (!emitted) lowered.functions[i].sections.front().plan.sweeps_apart = backend::better_apart(f);
    ir::TaskPlan plan = backend::plan_tasks(f);
    const int threads = backend::threads_of(f, plan);
    all.push_back({f.algorithm.function.name, emitted, std::move(plan), backend::usual_lanes(f), threads});
  }
  return all;
}

std::vector<std::string> functions_in_lanes(const Model& model, const Lowered& lowered) {
  return backend::functions_in_lanes(folder(model, lowered));
}

std::vector<backend::OutputFile> compile(const Model& model) {
  return emit(model, reference::self_test(model.tree, model.scene));
}

std::vector<backend::OutputFile> compile_without_self_test(const Model& model) { return emit(model, std::nullopt); }

}  // namespace dalembert
