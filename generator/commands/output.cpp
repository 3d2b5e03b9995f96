#include "commands/output.hpp"

#include <fmt/format.h>

#include "frontend/nearest.hpp"
#include "ir/identifier.hpp"

namespace dalembert {

namespace {

constexpr std::string_view jacobian_prefix = "jacobian_";

Output output_of(const Model& model, ir::Quantity quantity) {
  const ir::QuantityRow& row = ir::row_of(quantity);
  return {row.name, quantity, "", ir::extent(row.rows, model.tree), ir::extent(row.columns, model.tree)};
}

Output jacobian_of(const Model& model, const std::string& link) {
  return {std::string(jacobian_prefix) + ir::identifier(link), std::nullopt, link, 6, model.tree.nv()};
}

}  // namespace

Output output_named(const Model& model, const std::string& name) {
  const auto refuse = [&](std::string message, std::string remedy) {
    throw InputError({Severity::error, "", "option --output", std::move(message), std::move(remedy)});
  };
  if (const std::optional<ir::Quantity> quantity = ir::quantity_named(name)) {
    if (model.scene.rates_zero && *quantity == ir::Quantity::coriolis_matrix)
      refuse("coriolis_matrix is zero when rates_zero is set", "remove one of the two");
    return output_of(model, *quantity);
  }
  if (name.starts_with(jacobian_prefix)) {
    const std::string link = name.substr(jacobian_prefix.size());
    std::vector<std::string> links;
    for (const ir::LinkPlacement& placement : model.tree.links) {
      if (placement.link == link || ir::identifier(placement.link) == link) {
        if (placement.body < 0 && !model.tree.floating_base)
          refuse(fmt::format("link '{}' does not move: the base is fixed", link), "name a link beyond a moving joint");
        return jacobian_of(model, placement.link);
      }
      links.push_back(placement.link);
    }
    refuse(fmt::format("there is no link '{}'", link), frontend::suggestion(link, links));
  }
  std::vector<std::string> names;
  for (const ir::QuantityRow& row : ir::quantities()) names.emplace_back(row.name);
  names.push_back("jacobian_LINK");
  refuse(fmt::format("the quantity '{}' is unknown", name), frontend::suggestion(name, names));
  return {};
}

std::vector<Output> outputs_of(const Model& model) {
  std::vector<Output> outputs;
  for (ir::Quantity quantity : model.scene.outputs) outputs.push_back(output_of(model, quantity));
  for (const std::string& link : model.scene.jacobians) outputs.push_back(jacobian_of(model, link));
  return outputs;
}

Model with_outputs(Model model, const std::vector<Output>& outputs) {
  model.scene.outputs.clear();
  model.scene.jacobians.clear();
  model.scene.parallel = ir::Parallel::serial;
  for (const Output& output : outputs) {
    if (output.quantity) model.scene.outputs.push_back(*output.quantity);
    else model.scene.jacobians.push_back(output.link);
  }
  return model;
}

}  // namespace dalembert
