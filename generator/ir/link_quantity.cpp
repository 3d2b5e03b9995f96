#include "ir/link_quantity.hpp"

#include "ir/identifier.hpp"

namespace dalembert::ir {

const std::vector<LinkQuantityRow>& link_quantities() {
  static const std::vector<LinkQuantityRow> rows{
#define DALEMBERT_LINK_QUANTITY(name, symbol, rows, columns, unit, by_default, scale, help) \
  {LinkQuantity::name, #name, symbol, Extent::rows, Extent::columns, unit, by_default, LinkScale::scale, help},
#include "ir/link_quantities.def"
#undef DALEMBERT_LINK_QUANTITY
  };
  return rows;
}

const LinkQuantityRow& row_of(LinkQuantity quantity) { return link_quantities()[static_cast<std::size_t>(quantity)]; }

std::optional<LinkQuantity> link_quantity_named(std::string_view name) {
  for (const LinkQuantityRow& row : link_quantities())
    if (row.name == name) return row.quantity;
  return std::nullopt;
}

std::string name_of(const LinkOutput& output) {
  return std::string(row_of(output.quantity).name) + "_" + identifier(output.link);
}

std::string help_of(const LinkOutput& output) {
  std::string text = row_of(output.quantity).help;
  const std::string placeholder = "LINK";
  if (const size_t at = text.find(placeholder); at != text.npos) text.replace(at, placeholder.size(), output.link);
  return text;
}

}  // namespace dalembert::ir
