#include "ir/emitted_function.hpp"

#include <algorithm>

#include "ir/scene.hpp"

namespace dalembert::ir {
namespace {

bool is_lower(char c) { return 'a' <= c && c <= 'z'; }

std::string type_name(const std::string& name) {
  std::string type;
  bool capital = true;
  for (const char c : name) {
    if (c != '_') type += capital && is_lower(c) ? static_cast<char>(c - 'a' + 'A') : c;
    capital = c == '_';
  }
  return type;
}

}  // namespace

bool EmittedFunction::computes(Quantity quantity) const {
  return std::find(quantities.begin(), quantities.end(), quantity) != quantities.end();
}

const Part* EmittedFunction::part(Quantity quantity) const {
  const auto found = parts.find(quantity);
  return found == parts.end() ? nullptr : &found->second;
}

bool EmittedFunction::any_part() const {
  return !parts.empty() ||
         std::any_of(of_links.begin(), of_links.end(), [](const LinkOutput& output) { return output.part.has_value(); });
}

std::string EmittedFunction::acceleration_result() const {
  for (const Quantity quantity : {Quantity::constrained_forward_dynamics, Quantity::forward_dynamics})
    if (computes(quantity)) return result(quantity);
  return "";
}

bool EmittedFunction::moves_as_held() const { return computes(Quantity::constrained_forward_dynamics); }

std::string EmittedFunction::impact_result() const { return computes(Quantity::impact) ? result(Quantity::impact) : ""; }

EmittedFunction standard_function(Function function) { return {row_of(function).name, row_of(function).type, function}; }

EmittedFunction named_function(const std::string& name, const std::vector<Quantity>& quantities,
                               const std::vector<LinkOutput>& of_links, const std::map<Quantity, Part>& parts) {
  EmittedFunction function{name, type_name(name), Function::evaluate, true, quantities, of_links, parts};
  std::sort(function.quantities.begin(), function.quantities.end());
  for (const Quantity quantity : quantities)
    if (row_of(quantity).function != Function::evaluate) function.inputs = row_of(quantity).function;
  return function;
}

std::vector<EmittedFunction> functions_of(const Scene& scene) {
  std::vector<EmittedFunction> all;
  for (const FunctionRow& row : functions) {
    EmittedFunction function = standard_function(row.function);
    for (const Quantity quantity : scene.outputs)
      if (row_of(quantity).function == row.function) function.quantities.push_back(quantity);
    for (const auto& [quantity, part] : scene.parts)
      if (function.computes(quantity)) function.parts.emplace(quantity, part);
    if (function.is_evaluate()) function.of_links = scene.link_outputs();
    if (!function.quantities.empty() || !function.of_links.empty()) all.push_back(std::move(function));
  }
  for (const NamedFunction& f : scene.functions) all.push_back(named_function(f.name, f.quantities, f.of_links, f.parts));
  return all;
}

}  // namespace dalembert::ir
