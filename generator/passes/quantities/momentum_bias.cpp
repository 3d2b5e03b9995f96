// dA/dt v: the rate of the robot's momentum about its centre of mass, world axes, where v̇ = 0: the wrench on the base that
// Newton-Euler finds without gravity, moved to the centre of mass.
#include "passes/quantities/mass_center.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

using ir::Shape;

void describe_momentum_bias(Builder& b, int array) {
  if (b.scene().rates_zero) return;  // a new workspace has it: zero
  const int wrench = newton_euler(b, Driven::weightless).subtree_wrench, first = first_moments(b), inverse = inverse_mass(b);
  const int rate = b.role({"momentum_bias", "dAv", "dA/dt v", "N, N m", Shape::wrench});
  SweepBuilder s = b.sweep_of_base("momentum_bias", "dA/dt v = [X f; X (n - h/m x f)]");
  const Vec3 f = s.own3(wrench, 0), n = s.own3(wrench, 3), h = s.own3(first), lever = s.own(inverse) * h;
  const Vec3 about_center = n - cross(lever, f);
  const Mat3 to_world = s.base_axes();
  const Vec3 angular = to_world * about_center, linear = to_world * f;
  s.store(rate, Twist{linear, angular});
  b.result({array, ir::Layout::base, rate});
}

}  // namespace dalembert::passes
