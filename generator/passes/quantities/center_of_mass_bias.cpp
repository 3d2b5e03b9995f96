// dJc/dt v: the acceleration of the centre of mass, world axes, where v̇ = 0: the force on the base that Newton-Euler finds
// without gravity, per mass.
#include "passes/quantities/mass_center.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

using ir::Shape;

void describe_center_of_mass_bias(Builder& b, int array) {
  if (b.scene().rates_zero) return;  // a new workspace has it: zero
  const int wrench = newton_euler(b, Driven::weightless).subtree_wrench, inverse = inverse_mass(b);
  const int bias = b.role({"center_bias", "dJcv", "dJc/dt v", "m/s^2", Shape::vector});
  SweepBuilder s = b.sweep_of_base("center_bias", "dJc/dt v = X f/m");
  const Vec3 f = s.own3(wrench, 0), per_mass = s.own(inverse) * f;
  s.store(bias, s.base_axes() * per_mass);
  b.result({array, ir::Layout::base, bias});
}

}  // namespace dalembert::passes
