// M⁻¹ = L⁻¹ D⁻¹ L⁻ᵀ: an element sums over the coordinates above both of its own, which are few on a tree. L's elements are
// pairs.
#include "dalembert/chain_shapes.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

namespace {

// L' of articulated bodies: M is not formed.
int transposed_gains(Builder& b) {
  if (const int made = b.guard()->factor; made >= 0) return made;
  const Articulated a = articulated_bodies(b);
  const Poses p = poses(b);
  ir::Pairs l;
  l.array = b.internal_array(b.own_name("factor"), b.tree().nv(), b.tree().nv());
  l.equation = "L_ki = V_k.J_i";
  l.symmetric = true;  // only the half above the diagonal is read
  l.above = {{a.gain, 0, p.joint_linear, 0}, {a.gain, 3, p.joint_angular, 0}};
  b.pairs(l);
  return b.guard()->factor = l.array;
}

}  // namespace

TreeFactors tree_factors(Builder& b) {
  const int upper = b.factors() ? mass_matrix_factor(b) : transposed_gains(b);
  return {upper, b.guard()->pivots};
}

int inverse_mass_matrix(Builder& b, int array) {
  const int nv = b.tree().nv();
  if (array < 0) array = b.internal_array(b.own_name("inverse"), nv, nv);
  guard(b, array);
  const TreeFactors factors = tree_factors(b);
  const int room = b.internal_array(b.own_name("padded_inverse"), inverse_size(nv), 1);
  b.kernel(ir::Kernel(ir::Kernel::Kind::invert, {{ir::Operand::factor, factors.upper},
                                                 {ir::Operand::pivots, factors.pivots},
                                                 {ir::Operand::inverse, room},
                                                 {ir::Operand::to, array}}));
  return array;
}

void describe_inverse_mass_matrix(Builder& b, int array) { inverse_mass_matrix(b, array); }

}  // namespace dalembert::passes
