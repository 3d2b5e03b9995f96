// The quantities a user can ask for, by the names used on the command line, in scenes and in the emitted API.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ir/function.hpp"

namespace dalembert::ir {

enum class Quantity {
#define DALEMBERT_QUANTITY(name, ...) name,
#include "ir/quantities.def"
#undef DALEMBERT_QUANTITY
};

// How many rows or columns: a number, or one per velocity coordinate, or six or ten per body that moves, the base included, or
// one per row of the scene's constraints.
enum class Extent { one, three, four, six, nv, six_per_body, ten_per_body, constraint_rows };

// What errors are measured against at least where a quantity vanishes by cancellation (see check): nothing but its own largest
// element; |M| |v|; the quantity with gravity in other directions; |M| |v|²; that and the gravity term. Solved: its own, where
// errors grow by the condition of M. Turning: |J| |v|², of the Jacobian whose rate it is. Constrained: solved, where errors
// grow by the condition of the constraints too. Supported: as force, where errors grow by the condition of what constraints
// bear.
enum class Scale { own, momentum, weight, centrifugal, force, solved, turning, constrained, supported };

// What of the robot a quantity makes no sense without: nothing, a mass or an inertia that moves, a mass.
enum class Needs { nothing, mass, center };

struct QuantityRow {
  Quantity quantity;
  const char *name, *symbol;
  Function function;
  Extent rows, columns;
  const char* unit;
  bool by_default;
  Scale scale;
  Needs needs;
  const char* help;
};

// Whether it is solved for with M.
inline bool is_solved(Scale scale) { return scale == Scale::solved || scale == Scale::constrained; }

// In the order of quantities.def.
const std::vector<QuantityRow>& quantities();
const QuantityRow& row_of(Quantity quantity);
std::vector<Quantity> default_quantities();
inline bool is_any_of(Quantity quantity, std::initializer_list<Quantity> list) {
  return std::find(list.begin(), list.end(), quantity) != list.end();
}
// Whether it is of constraints, and there is none where the scene has none.
bool is_of_constraints(Quantity quantity);
// Whether it is computed where loops are embedded.
bool is_of_linkages(Quantity quantity);

struct KinematicTree;
int extent(Extent extent, const KinematicTree& tree);
// A shape in the names of the generated header: "nv x nv", "6 x nv", "nv"; empty for a single number.
std::string shape(Extent rows, Extent columns);

// "mass_matrix" and so on, and back; nothing for a name that is none.
std::string_view name_of(Quantity quantity);
std::optional<Quantity> quantity_named(std::string_view name);

}  // namespace dalembert::ir
