// v̇ = M⁻¹ (τ − C v − g), by articulated bodies or by M's factors.
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

int unbalanced(Builder& b) {
  const NewtonEuler rest = newton_euler(b, Driven::at_rest);
  const int bias = less_external(b, rest.torque), external = external_wrenches(b);
  const int residual = b.role({"unbalanced", "e", "tau - (C v + g)", "N, N m", ir::Shape::scalar});
  if (b.has("unbalanced")) return residual;
  SweepBuilder s = b.sweep("unbalanced", "e = tau - (C v + g)", ir::Direction::anywhere);
  const Sym biased = s.own(bias), motor = s.effort();
  s.store(residual, s.parameter(own_coordinate_p) * motor - biased);
  if (b.base_coordinates() == 0) return residual;
  SweepBuilder base = b.sweep_of_base("base_unbalanced", "e = tau - (C v + g)");
  const Twist effort = base.base_effort();
  for (int j = 0; j < 6; ++j) {
    const auto at = static_cast<std::size_t>(j % 3);
    const Sym unbalanced = (j < 3 ? effort.linear[at] : effort.angular[at]) - base.own(rest.subtree_wrench, j);
    base.store(residual, 0, external < 0 ? unbalanced : unbalanced + base.own(external, j), j);
  }
  return residual;
}

void describe_forward_dynamics(Builder& b, int array) {
  const int role = b.factors() ? unbalanced(b) : solved_accelerations(b).acceleration;
  b.result({array, ir::Layout::per_coordinate, role});
  guard(b, array);
  if (b.factors())
    b.kernel(ir::Kernel(ir::Kernel::Kind::solve, {{ir::Operand::factor, mass_matrix_factor(b)}, {ir::Operand::to, array}}));
}

}  // namespace dalembert::passes
