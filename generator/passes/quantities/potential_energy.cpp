// U = −Σ m γ·c = −γ·(m x + X h): x and X the base's position and axes in the world, h the robot's first moment along them.
#include "passes/quantities/mass_center.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::Shape;

void describe_potential_energy(Builder& b, int array) {
  if (b.scene().gravity_kind == ir::GravityKind::none) return;  // a new workspace has it: zero
  const int first = first_moments(b), mass = composite_mass(b);
  const int energy = b.role({"potential_energy", "U", "U", "J", Shape::scalar});
  SweepBuilder s = b.sweep("height", "U = -gravity.(m x + X h)", Direction::root);
  const Vec3 in_base = s.gravity_in_base(), h = s.own3(first), in_world = s.gravity_in_world(), x = s.base_position();
  const Sym turned = dot(in_base, h), lowered = dot(in_world, x), moved = s.own(mass) * lowered;
  s.store(energy, -(moved + turned));
  b.result({array, ir::Layout::base, energy});
}

}  // namespace dalembert::passes
