// What a user can ask of a link by name: its frame's pose, velocity and derivatives.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ir/part.hpp"
#include "ir/quantity.hpp"

namespace dalembert::ir {

enum class LinkQuantity {
#define DALEMBERT_LINK_QUANTITY(name, ...) name,
#include "ir/link_quantities.def"
#undef DALEMBERT_LINK_QUANTITY
};

// What errors are measured against at least: nothing but its own largest element; |J| |v|; |J| |v|².
enum class LinkScale { own, rate, rate_squared };

struct LinkQuantityRow {
  LinkQuantity quantity;
  const char *name, *symbol;
  Extent rows, columns;
  const char* unit;
  bool by_default;
  LinkScale scale;
  const char* help;
};

// In the order of link_quantities.def.
const std::vector<LinkQuantityRow>& link_quantities();
const LinkQuantityRow& row_of(LinkQuantity quantity);
std::optional<LinkQuantity> link_quantity_named(std::string_view name);

// One output: a quantity of a link.
struct LinkOutput {
  LinkQuantity quantity = LinkQuantity::jacobian;
  std::string link;
  std::optional<Part> part{};  // which columns; nothing: all
  bool operator==(const LinkOutput& other) const { return quantity == other.quantity && link == other.link; }
};
// "jacobian_left_hand", an identifier.
std::string name_of(const LinkOutput& output);
// What it is, in a sentence with the link's name.
std::string help_of(const LinkOutput& output);

}  // namespace dalembert::ir
