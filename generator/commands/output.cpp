#include "commands/output.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "frontend/nearest.hpp"
#include "ir/aliases.hpp"
#include "ir/identifier.hpp"

namespace dalembert {

namespace {

Output output_of(const Model& model, ir::Quantity quantity, const std::map<ir::Quantity, ir::Part>& parts) {
  const ir::QuantityRow& row = ir::row_of(quantity);
  const auto part = parts.find(quantity);
  const ir::Part* const asked = part == parts.end() ? nullptr : &part->second;
  return {row.name,
          quantity,
          "",
          {},
          ir::extent(row.rows, model.tree, asked),
          ir::extent(row.columns, model.tree, asked),
          ir::standard_function(row.function),
          asked ? std::optional(*asked) : std::nullopt};
}

Output output_of(const Model& model, const ir::LinkOutput& output) {
  const ir::LinkQuantityRow& row = ir::row_of(output.quantity);
  const ir::Part* const asked = output.part ? &*output.part : nullptr;
  return {ir::name_of(output),
          std::nullopt,
          output.link,
          output.quantity,
          ir::extent(row.rows, model.tree, asked),
          ir::extent(row.columns, model.tree, asked),
          ir::standard_function(ir::Function::evaluate),
          output.part};
}

// Of the functions that the scene names.
std::vector<Output> named_outputs(const Model& model) {
  std::vector<Output> outputs;
  for (const ir::NamedFunction& f : model.scene.functions) {
    const ir::EmittedFunction function = ir::named_function(f.name, f.quantities, f.of_links, f.parts);
    const auto add = [&](Output output, const auto& quantity) {
      output.name = function.result(quantity);
      output.function = function;
      outputs.push_back(std::move(output));
    };
    for (const ir::Quantity quantity : function.quantities) add(output_of(model, quantity, f.parts), quantity);
    for (const ir::LinkOutput& output : function.of_links) add(output_of(model, output), output);
  }
  return outputs;
}

}  // namespace

std::pair<ir::Extent, ir::Extent> Output::axes() const {
  const auto of = [](const auto& row) { return std::pair(row.rows, row.columns); };
  return quantity ? of(ir::row_of(*quantity)) : of(ir::row_of(of_link));
}

const char* Output::registered() const { return quantity ? ir::row_of(*quantity).name : ir::row_of(of_link).name; }

ir::Selection Output::selection() const {
  const auto [along_rows, along_columns] = axes();
  return ir::selection(part ? &*part : nullptr, along_rows, along_columns);
}

Output output_named(const Model& model, const std::string& name) {
  const auto refuse = [&](std::string message, std::string remedy) {
    throw InputError({Severity::error, "", "option --output", std::move(message), std::move(remedy)});
  };
  if (const auto quantity = ir::quantity_named(ir::named_by_us(name, ir::quantity_aliases()))) {
    if (model.scene.rates_zero && *quantity == ir::Quantity::coriolis_matrix)
      refuse("coriolis_matrix is zero when rates_zero is set", "remove one of the two");
    if (!model.scene.any_constraint() && ir::is_of_constraints(*quantity))
      refuse(fmt::format("{} is asked for, and there is neither a contact nor a loop", name),
             "say where the robot is held: --contacts left_foot=weld, or which links hold each other: --loops");
    return output_of(model, *quantity, model.scene.parts);
  }
  const std::vector<Output> named = named_outputs(model);
  for (const Output& output : named)
    if (output.name == name) return output;
  // What the scene asks for is called so; of anything else the name has to tell what it is: jacobian_world_hand is the
  // jacobian_world of a hand, or the jacobian of a link world_hand.
  for (const ir::LinkOutput& asked : model.scene.link_outputs())
    if (ir::name_of(asked) == ir::identifier(name)) return output_of(model, asked);
  std::string link;
  std::vector<ir::LinkOutput> meant;
  for (const ir::LinkQuantityRow& row : ir::link_quantities()) {
    const std::string prefix = std::string(row.name) + "_";
    if (!name.starts_with(prefix)) continue;
    link = name.substr(prefix.size());
    for (const ir::LinkPlacement& placement : model.tree.links)
      if (placement.link == link || ir::identifier(placement.link) == link) meant.push_back({row.quantity, placement.link});
  }
  if (meant.size() > 1)
    refuse(fmt::format("'{}' is two things: {}, and {}", name, ir::help_of(meant[0]), ir::help_of(meant[1])),
           "ask for one of them in `frames`");
  if (!meant.empty()) {
    if (model.tree.find_link(meant[0].link)->body < 0 && model.tree.base_coordinates() == 0)
      refuse(fmt::format("link '{}' does not move: the base is fixed", meant[0].link),
             "name a descendant of a joint that moves");
    return output_of(model, meant[0]);
  }
  if (!link.empty()) {
    std::vector<std::string> links;
    for (const ir::LinkPlacement& placement : model.tree.links) links.push_back(placement.link);
    refuse(fmt::format("there is no link '{}'", link), frontend::suggestion(link, links));
  }
  std::vector<std::string> names;
  for (const ir::QuantityRow& row : ir::quantities()) names.emplace_back(row.name);
  for (const Output& output : named) names.push_back(output.name);
  for (const ir::LinkQuantityRow& row : ir::link_quantities()) names.push_back(std::string(row.name) + "_LINK");
  refuse(fmt::format("the quantity '{}' is unknown", name),
         frontend::suggestion(name, names, ir::names_of(ir::quantity_aliases())));
  return {};
}

std::vector<Output> outputs_of(const Model& model) {
  std::vector<Output> outputs;
  for (ir::Quantity quantity : model.scene.outputs) outputs.push_back(output_of(model, quantity, model.scene.parts));
  for (const ir::LinkOutput& output : model.scene.link_outputs()) outputs.push_back(output_of(model, output));
  for (Output& output : named_outputs(model)) outputs.push_back(std::move(output));
  return outputs;
}

Model with_outputs(Model model, const std::vector<Output>& outputs) {
  std::vector<ir::NamedFunction>& functions = model.scene.functions;
  std::erase_if(functions, [&](const ir::NamedFunction& f) {
    return std::none_of(outputs.begin(), outputs.end(),
                        [&](const Output& o) { return o.function.named && o.function.name == f.name; });
  });
  model.scene.outputs.clear();
  model.scene.jacobians.clear();
  model.scene.frames.clear();
  model.scene.parallel = ir::Parallel::serial;
  for (const Output& output : outputs) {
    if (output.function.named) continue;
    if (output.quantity) model.scene.outputs.push_back(*output.quantity);
    else model.scene.frames.push_back({output.of_link, output.link, output.part});
  }
  return model;
}

}  // namespace dalembert
