// dv̇/dq = −M⁻¹ dτ/dq and dv̇/dv = −M⁻¹ dτ/dv at the v̇ of forward dynamics (Carpentier and Mansard 2018).
//
// Articulated bodies give v̇ in the sweeps. Where M's factors give it, it is there behind all sweeps: what depends on it has
// sweeps in a section of its own, which take v̇ as inverse dynamics does. That spares an arm the long recursion by which
// articulated bodies wait for each other.
#include <algorithm>
#include <functional>

#include "dalembert/chain_shapes.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

int padded_inverse(Builder& b) {
  if (!b.made({ir::Kernel::Kind::invert})) inverse_mass_matrix(b);
  return (*b.made({ir::Kernel::Kind::invert}))[ir::Operand::inverse];
}

void negative_product(Builder& b, int inverse, int efforts, int to, int first) {
  ir::Kernel product(ir::Kernel::Kind::negative_product,
                     {{ir::Operand::inverse, inverse}, {ir::Operand::efforts, efforts}, {ir::Operand::to, to}});
  product.first = first;
  b.kernel(product);
}

namespace {

// Of the base's coordinates from `first` on, what three of them do to the base's linear acceleration alone: it is u' + w
// x u less gravity that equations of motion know, along the base's axes. Nothing else changes.
void set_base_columns(Builder& b, int array, const std::string& name, int first, const std::string& equation,
                      const std::function<Vec3(SweepBuilder&)>& about, double sign) {
  SweepBuilder base = b.sweep_of_base(b.own_name(name), equation);
  const Vec3 axis = about(base);
  for (int j = 0; j < 3; ++j) {
    const auto next = static_cast<std::size_t>((j + 1) % 3), last = static_cast<std::size_t>((j + 2) % 3);
    const int role = b.role({b.own_name(name) + "_" + "xyz"[j], "dv", equation, "", ir::Shape::vector});
    Vec3 column = base.zero();  // axis x e_j
    column[next] = sign > 0 ? axis[last] : -axis[last];
    column[last] = sign > 0 ? -axis[next] : axis[next];
    base.store(role, column);
    b.result({array, ir::Layout::base, role, (first + j) * b.tree().nv()});
  }
}

// first: the efforts do not depend on the coordinates before this one, or what these do is known.
void solve(Builder& b, int array, const std::string& name, void (*of_efforts)(Builder&, int), int first) {
  const int nv = b.tree().nv(), efforts = b.internal_array(b.own_name(name), nv, nv);
  of_efforts(b, efforts);
  negative_product(b, padded_inverse(b), efforts, array, first);
  guard(b, array);
}

void derive_by_q(Builder& b, int array) {
  if (b.base_coordinates() == 0) return solve(b, array, "efforts_dq", describe_inverse_dynamics_dq, 0);
  // Nothing depends on the base's position; gravity turns against it, wrenches along the world's axes do not turn with it.
  const bool in_world = std::any_of(b.scene().wrenches.begin(), b.scene().wrenches.end(),
                                    [](const ir::ExternalWrench& wrench) { return wrench.in_world; });
  solve(b, array, "efforts_dq", describe_inverse_dynamics_dq, in_world ? 3 : 6);
  if (in_world) return;
  const auto gravity = [](SweepBuilder& base) { return base.gravity_in_base(); };
  set_base_columns(b, array, "base_turned", 3, "gravity x e_j along the base's axes", gravity, 1);
}

void derive_by_v(Builder& b, int array) {
  solve(b, array, "efforts_dv", describe_inverse_dynamics_dv, b.base_coordinates() > 0 ? 3 : 0);
  if (b.base_coordinates() == 0) return;
  const auto spin = [](SweepBuilder& base) { return base.base_twist().angular; };
  set_base_columns(b, array, "base_moved", 0, "-w x e_j along the base's axes", spin, -1);
}

// v̇ as an array, by M's factors.
int accelerations_by_factors(Builder& b) {
  if (b.computes(ir::Quantity::forward_dynamics)) return b.output(ir::Quantity::forward_dynamics);
  const std::string name = b.own_name("accelerations");
  if (const int made = b.array_called(name); made >= 0) return made;
  const int array = b.internal_array(name, b.tree().nv(), 1);
  describe_forward_dynamics(b, array);
  return array;
}

// Behind v̇, where sweeps do not give it.
void derive(Builder& b, ir::Quantity quantity, int array, void (*by)(Builder&, int)) {
  const bool all_own = b.tree().independent_joints() == b.tree().joints();
  const bool in_sweeps = all_own && (!b.factors() || b.purpose().in_one_section);
  // dv̇/dv alone does not depend on v̇.
  if (in_sweeps || !b.computes(ir::Quantity::forward_dynamics_dq)) return by(b, array);
  padded_inverse(b);
  b.behind("derivatives", "Derivatives", accelerations_by_factors(b), -1, quantity, [=](Builder& next) { by(next, array); });
  guard(b, array);
}

}  // namespace

void describe_forward_dynamics_dq(Builder& b, int array) { derive(b, ir::Quantity::forward_dynamics_dq, array, derive_by_q); }

void describe_forward_dynamics_dv(Builder& b, int array) { derive(b, ir::Quantity::forward_dynamics_dv, array, derive_by_v); }

}  // namespace dalembert::passes
