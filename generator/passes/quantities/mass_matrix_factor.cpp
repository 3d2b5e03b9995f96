// M = U D U', eliminated from the last coordinate to the first (Featherstone 2008, section 6.3; D and U' are those of
// articulated bodies). What moves by a driver's coordinate is in M already.
#include "dalembert/chain_shapes.hpp"
#include "ir/coordinate_tree.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

namespace {

using Kind = ir::Kernel::Kind;
using ir::Operand;

// As an array: the output, where that is the whole, or one that is none.
int own_array(Builder& b, ir::Quantity quantity, const char* name) {
  const int nv = b.tree().nv();
  return b.computes(quantity) && !b.function().part(quantity) ? b.output(quantity) : b.internal_array(b.own_name(name), nv, nv);
}

}  // namespace

int mass_matrix_factor(Builder& b) {
  if (const auto made = b.made({Kind::factor})) return (*made)[Operand::factor];
  const int nv = b.tree().nv(), mass = own_array(b, ir::Quantity::mass_matrix, "mass");
  describe_mass_matrix(b, mass);
  const int array = own_array(b, ir::Quantity::mass_matrix_factor, "factor");
  const int longest = ir::most_above(ir::coordinate_tree(b.tree())) + 1;
  const int room = b.internal_array(b.own_name("unscaled_factor"), factor_stride(longest), nv);
  b.guard() =
      ir::Guard{b.internal_array(b.own_name("pivots"), nv, 1), b.internal_array(b.own_name("diagonal"), nv, 1), {}, array};
  b.kernel(ir::Kernel(Kind::factor, {{Operand::mass, mass},
                                     {Operand::unscaled, room},
                                     {Operand::factor, array},
                                     {Operand::pivots, b.guard()->pivots},
                                     {Operand::diagonal, b.guard()->diagonal}}));
  return array;
}

void describe_mass_matrix_factor(Builder& b, int array) {
  guard(b, array);
  b.solve_by(array);
}

}  // namespace dalembert::passes
