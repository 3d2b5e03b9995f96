// M = U D U', eliminated from the last coordinate to the first (Featherstone 2008, section 6.3; D and U' are those of
// articulated bodies). What moves by a driver's coordinate is in M already.
#include <algorithm>
#include <vector>

#include "dalembert/chain_shapes.hpp"
#include "ir/coordinate_tree.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

namespace {

using Kind = ir::Kernel::Kind;
using ir::Direction;
using ir::Operand;
using ir::Shape;

// As an array: the output, where that is the whole, or one that is none.
int own_array(Builder& b, ir::Quantity quantity, const char* name) {
  const int nv = b.tree().nv();
  return b.computes(quantity) && !b.function().part(quantity) ? b.output(quantity) : b.internal_array(b.own_name(name), nv, nv);
}

// M_kk of every coordinate, its joint's and those of joints that follow it each taken by itself: what rounding has left of M_kk
// where they cancel. Where they do not M_kk may be as many times more as there are of them, which 4096 roundings have room for.
// −1: no joint follows another, and M's diagonal says the same.
int diagonal_apart(Builder& b) {
  const std::vector<ir::Body>& bodies = b.tree().bodies;
  if (std::none_of(bodies.begin(), bodies.end(), [](const ir::Body& body) { return body.driven(); })) return -1;
  const int role = b.role({"diagonal_apart", "Mkk", "M_kk of the joint by itself", "kg or kg m^2", Shape::scalar});
  const int array = b.internal_array(b.own_name("diagonal_apart"), b.tree().nv(), 1);
  b.result({array, ir::Layout::per_coordinate, role});
  const Poses p = poses(b);
  const int force = forces(b).inertia;
  SweepBuilder s = b.sweep("diagonals_apart", "M_kk = F_k.J_k", Direction::anywhere);
  const Sym armature = s.parameter(b.armature());
  const Twist joint = joint_of(s, p);
  s.store(role, element({s.own3(force, 0), s.own3(force, 3)}, joint) + armature);
  if (b.base_coordinates() == 0) return array;
  SweepBuilder base = b.sweep_of_base("base_diagonals", "M_BB = A*");
  for (int k = 0; k < 6; ++k) {
    const Twist unit = unit_twist(base, k);
    const Sums sums = sums_of(base, subtree_sums(b));
    base.store(role, 0, element(apply_inertia(base.own(composite_mass(b)), sums, unit), unit), k);
  }
  return array;
}

}  // namespace

int mass_matrix_factor(Builder& b) {
  if (const auto made = b.made({Kind::factor})) return (*made)[Operand::factor];
  const int nv = b.tree().nv(), mass = own_array(b, ir::Quantity::mass_matrix, "mass");
  describe_mass_matrix(b, mass);
  const int array = own_array(b, ir::Quantity::mass_matrix_factor, "factor");
  const int longest = ir::most_above(ir::coordinate_tree(b.tree())) + 1;
  const int room = b.internal_array(b.own_name("unscaled_factor"), factor_stride(longest), nv);
  const int pivots = b.internal_array(b.own_name("pivots"), nv, 1), diagonal = b.internal_array(b.own_name("diagonal"), nv, 1);
  const int apart = diagonal_apart(b);
  b.guard() = ir::Guard{pivots, apart >= 0 ? apart : diagonal, {}, array};
  b.kernel(ir::Kernel(Kind::factor, {{Operand::mass, mass},
                                     {Operand::unscaled, room},
                                     {Operand::factor, array},
                                     {Operand::pivots, pivots},
                                     {Operand::diagonal, diagonal}}));
  return array;
}

void describe_mass_matrix_factor(Builder& b, int array) {
  guard(b, array);
  b.solve_by(array);
}

}  // namespace dalembert::passes
