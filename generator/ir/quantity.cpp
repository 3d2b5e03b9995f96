#include "ir/quantity.hpp"

namespace dalembert::ir {

std::string_view name_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::mass_matrix: return "mass_matrix";
    case Quantity::coriolis_matrix: return "coriolis_matrix";
    case Quantity::gravity: return "gravity";
    case Quantity::bias: return "bias";
    case Quantity::wrench_influence: return "wrench_influence";
  }
  return "";
}

std::optional<Quantity> quantity_named(std::string_view name) {
  for (Quantity quantity : all_quantities)
    if (name_of(quantity) == name) return quantity;
  return std::nullopt;
}

}  // namespace dalembert::ir
