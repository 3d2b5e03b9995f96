// The quantities a user can ask for, by the names used on the command line, in scenes and in the emitted API.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace dalembert::ir {

enum class Quantity {
  mass_matrix,       // M, nv × nv
  coriolis_matrix,   // C, nv × nv
  gravity,           // g, nv
  bias,              // C v + g, nv (Newton-Euler, O(n))
  wrench_influence,  // W, nv × 6·(number of bodies): transposed body Jacobians, base first when it floats
};

inline constexpr Quantity all_quantities[] = {Quantity::mass_matrix, Quantity::coriolis_matrix, Quantity::gravity,
                                              Quantity::bias, Quantity::wrench_influence};

// "mass_matrix" and so on, and back; nothing for a name that is none.
std::string_view name_of(Quantity quantity);
std::optional<Quantity> quantity_named(std::string_view name);

}  // namespace dalembert::ir
