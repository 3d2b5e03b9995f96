#include "ir/quantity.hpp"

#include "ir/kinematic_tree.hpp"
#include "ir/moved_links.hpp"

namespace dalembert::ir {

const std::vector<QuantityRow>& quantities() {
  static const std::vector<QuantityRow> rows{
#define DALEMBERT_QUANTITY(name, symbol, function, rows, columns, unit, by_default, scale, needs, help) \
  {Quantity::name, #name,      symbol,       Function::function, Extent::rows, Extent::columns,         \
   unit,           by_default, Scale::scale, Needs::needs,       help},
#include "ir/quantities.def"
#undef DALEMBERT_QUANTITY
  };
  return rows;
}

const QuantityRow& row_of(Quantity quantity) { return quantities()[static_cast<std::size_t>(quantity)]; }

std::vector<Quantity> default_quantities() {
  std::vector<Quantity> list;
  for (const QuantityRow& row : quantities())
    if (row.by_default) list.push_back(row.quantity);
  return list;
}

bool is_of_constraints(Quantity quantity) {
  const QuantityRow& row = row_of(quantity);
  return row.scale == Scale::constrained || row.scale == Scale::supported || row.rows == Extent::constraint_rows;
}

bool is_of_linkages(Quantity quantity) {
  switch (quantity) {
    case Quantity::inverse_dynamics_dq:
    case Quantity::inverse_dynamics_dv:
    case Quantity::forward_dynamics_dq:
    case Quantity::forward_dynamics_dv: return false;
    default: return !is_of_constraints(quantity);
  }
}

int extent(Extent extent, const KinematicTree& tree) {
  switch (extent) {
    case Extent::one: return 1;
    case Extent::three: return 3;
    case Extent::four: return 4;
    case Extent::six: return 6;
    case Extent::nv: return tree.within ? tree.within->nv : tree.nv();
    case Extent::six_per_body: return 6 * count_of_links(tree);
    case Extent::ten_per_body: return 10 * count_of_links(tree);
    case Extent::constraint_rows: return tree.constraint_rows;
  }
  return 0;
}

std::string shape(Extent rows, Extent columns) {
  const auto text = [](Extent extent) -> std::string {
    switch (extent) {
      case Extent::one: return "1";
      case Extent::three: return "3";
      case Extent::four: return "4";
      case Extent::six: return "6";
      case Extent::nv: return "nv";
      case Extent::six_per_body: return "6 bodies";
      case Extent::ten_per_body: return "10 bodies";
      case Extent::constraint_rows: return "rows";
    }
    return "";
  };
  if (columns == Extent::one) return rows == Extent::one ? "" : text(rows);
  return text(rows) + " x " + text(columns);
}

std::string_view name_of(Quantity quantity) { return row_of(quantity).name; }

std::optional<Quantity> quantity_named(std::string_view name) {
  for (const QuantityRow& row : quantities())
    if (row.name == name) return row.quantity;
  return std::nullopt;
}

}  // namespace dalembert::ir
