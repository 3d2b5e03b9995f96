#include "commands/report/forms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>

#include "compile.hpp"
#include "costs.hpp"
#include "left_out.hpp"

namespace dalembert::reporting {
namespace {

const char* name_of(ir::Form form) { return form == ir::Form::rolled ? "rolled" : "straight"; }

void add_plan(const Subject& subject, const Lowered& lowered, Rows& rows) {
  for (const LoweredFunction& function : lowered.functions) {
    const std::string& name = function.name();
    const ir::Plan& plan = function.first().plan;
    rows.text("form", "function " + name, "all", "", "form", name_of(plan.form));
    for (const ir::Segment& segment : plan.segments) {
      rows.number("form", name + ": " + segment.name, "all", "", "branches", segment.width, "branches");
      rows.number("form", name + ": " + segment.name, "all", "", "steps", segment.steps, "steps");
    }
  }
  for (const Output& output : subject.outputs)
    if (output.quantity) rows.text("form", "scene", output.name, "", "symbol", ir::row_of(*output.quantity).symbol);
  for (const Output& output : subject.outputs)
    rows.text("form", "alone", output.name, "", "form",
              name_of(lower(with_outputs(subject.model, {output})).functions.front().first().plan.form));
  rows.number("form", "scene", "all", "", "workspace", static_cast<double>(workspace_bytes(subject.model, lowered)), "bytes");
}

void add_operations(const OperationCost& cost, const char* variant, Rows& rows) {
  const auto add = [&](const char* metric, long count) {
    rows.number("operations", "scene", cost.name, variant, metric, static_cast<double>(count), "operations");
  };
  add("multiply", cost.operations.multiply);
  add("add", cost.operations.add);
  add("sincos", cost.operations.sincos);
  add("divide", cost.operations.divide);
}

void add_costs(const Subject& subject, const Lowered& lowered, Rows& rows) {
  const std::vector<OperationCost> here = operation_costs(lowered, subject.model.tree);
  const std::vector<OperationCost> before =
      too_large_to_compare(lowered) ? std::vector<OperationCost>{} : costs_before(subject.model);
  const auto known = [&](const std::string& name) {
    return std::any_of(here.begin(), here.end(), [&](const OperationCost& c) { return c.name == name; });
  };
  for (const OperationCost& cost : here) {
    add_operations(cost, "here", rows);
    if (const std::string unread = not_read(cost, subject.model.tree); !unread.empty())
      rows.text("left_out", "scene", cost.name, "", "not_read", unread);
  }
  for (const OperationCost& cost : before) {
    if (known(cost.name)) add_operations(cost, "before", rows);
    else rows.text("left_out", "scene", cost.name, "", "not_asked_for", "yes");
  }
}

// Arrays that kernels fill: the programs do not know their elements.
std::set<std::string> filled_by_kernels(const Lowered& lowered) {
  std::set<std::string> names;
  for (const LoweredSection* s : lowered.all_sections())
    for (const ir::Kernel& kernel : s->algorithm.kernels)
      for (const int array : kernel.filled()) names.insert(s->algorithm.arrays[static_cast<size_t>(array)].name);
  return names;
}

// Row by row: '.' is zero in every state, 'c' the same number in every state, 'x' any other.
void add_sparsity(const ir::Program& program, const std::set<std::string>& unknown, Rows& rows) {
  for (size_t a = 0; a < program.arrays.size(); ++a) {
    const ir::OutputArray& array = program.arrays[a];
    if (array.internal || array.columns == 1 || array.rows != array.columns || unknown.contains(array.name)) continue;
    std::vector<std::string> pattern(static_cast<size_t>(array.rows), std::string(static_cast<size_t>(array.columns), '.'));
    double filled = 0, constant = 0;
    for (const ir::OutputElement& e : program.elements) {
      if (e.array != static_cast<int>(a) || program.graph.is_constant(e.node, 0)) continue;
      const bool fixed = program.graph.is_constant(e.node);
      pattern[static_cast<size_t>(e.row)][static_cast<size_t>(e.column)] = fixed ? 'c' : 'x';
      filled += 1;
      constant += fixed;
    }
    rows.number("sparsity", "whole", array.name, "", "elements", static_cast<double>(array.rows * array.columns), "elements");
    rows.number("sparsity", "whole", array.name, "", "not_zero", filled, "elements");
    rows.number("sparsity", "whole", array.name, "", "constant", constant, "elements");
    for (size_t i = 0; i < pattern.size(); ++i)
      rows.text("sparsity", fmt::format("row {}", i), array.name, "", "pattern", pattern[i]);
  }
}

}  // namespace

void add_forms(const Subject& subject, Rows& rows) {
  const Lowered lowered = lower(subject.model, ir::Elements::kept);
  add_plan(subject, lowered, rows);
  add_costs(subject, lowered, rows);
  const std::set<std::string> unknown = filled_by_kernels(lowered);
  for (const LoweredFunction& function : lowered.functions) add_sparsity(function.first().program, unknown, rows);
}

}  // namespace dalembert::reporting
