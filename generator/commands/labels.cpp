#include "commands/labels.hpp"

#include <fmt/format.h>

#include <utility>

#include "ir/moved_links.hpp"

namespace dalembert {
namespace {

using Names = std::vector<std::string>;

const Names axes{"x", "y", "z"}, linear_and_angular{"linear_x", "linear_y", "linear_z", "angular_x", "angular_y", "angular_z"};
// Of a body's inertial parameters, about its link's origin, in the order of the regressor's columns.
const Names parameters{"m", "mx", "my", "mz", "xx", "xy", "xz", "yy", "yz", "zz"};

Names behind(const std::string& name, const Names& parts) {
  Names all;
  for (const std::string& part : parts) all.push_back(name + "_" + part);
  return all;
}

void append(Names& names, Names more) {
  for (std::string& name : more) names.push_back(std::move(name));
}

Names coordinate_names(const ir::KinematicTree& tree) {
  Names names;
  if (tree.base_coordinates() > 0) append(names, behind("base", linear_and_angular));
  for (const ir::Body& body : tree.bodies)
    if (body.independent()) names.push_back(body.joint);
  return names;
}

Names per_body(const ir::KinematicTree& tree, const Names& parts) {
  Names names;
  for (const std::string& link : ir::names_of_links(tree)) append(names, behind(link, parts));
  return names;
}

Names contact_rows(const ir::Scene& scene) {
  Names names;
  for (const ir::Contact& contact : scene.contacts)
    append(names, behind(contact.name, contact.type == ir::ContactType::weld ? linear_and_angular : axes));
  for (const ir::Loop& loop : scene.loops) {
    Names own;
    if (loop.type == ir::LoopType::distance) {
      own = {"distance"};
    } else {
      for (const int i : loop.linear_axes()) own.push_back(linear_and_angular[static_cast<size_t>(i)]);
      for (const int i : loop.angular_axes()) own.push_back(linear_and_angular[static_cast<size_t>(3 + i)]);
    }
    append(names, behind(loop.name, own));
  }
  return names;
}

Names names_along(ir::Extent extent, const Model& model) {
  switch (extent) {
    case ir::Extent::one: return {};
    case ir::Extent::three: return axes;
    case ir::Extent::four: return {"x_axis", "y_axis", "z_axis", "origin"};
    case ir::Extent::six: return linear_and_angular;
    case ir::Extent::nv: return coordinate_names(model.tree);
    case ir::Extent::six_per_body: return per_body(model.tree, linear_and_angular);
    case ir::Extent::ten_per_body: return per_body(model.tree, parameters);
    case ir::Extent::constraint_rows: return contact_rows(model.scene);
  }
  return {};
}

}  // namespace

Labels labels_of(const Model& model, const Output& output) {
  const auto [rows, columns] = output.axes();
  const auto asked = [](Names all, const std::optional<std::vector<int>>& numbers) {
    if (!numbers) return all;
    Names some;
    for (const int i : *numbers) some.push_back(all[static_cast<size_t>(i)]);
    return some;
  };
  const ir::Selection selection = output.selection();
  return {asked(names_along(rows, model), selection.rows), asked(names_along(columns, model), selection.columns)};
}

Words words_of(const Output& output) {
  if (output.quantity) {
    const ir::QuantityRow& row = ir::row_of(*output.quantity);
    return {row.symbol, row.unit, row.help};
  }
  const ir::LinkQuantityRow& row = ir::row_of(output.of_link);
  return {row.symbol, row.unit, ir::help_of({output.of_link, output.link})};
}

}  // namespace dalembert
