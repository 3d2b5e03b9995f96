// U = −Σ m γ·c = −γ·(m x + X h): x and X the base's position and axes in the world, h the robot's first moment along them.
// Springs add ½ k (q − rest)² each, so that T + U is what an undamped robot keeps.
#include "passes/quantities/mass_center.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::Shape;

namespace {

int spring_energy(Builder& b) {
  const int energy = b.role({"spring_energy", "Us", "energy of the subtree's springs", "J", Shape::scalar});
  SweepBuilder in = b.sweep("springs", "Us = Us_below + k (q - rest)^2/2", Direction::inwards);
  const Sym rest = in.parameter(rest_p), strain = in.coordinate() - rest, square = strain * strain, below = in.carried(energy);
  const Sym total = in.parameter(half_stiffness_p) * square + below;
  in.store(energy, total);
  in.hand_on(energy, 0, total);
  return energy;
}

}  // namespace

void describe_potential_energy(Builder& b, int array) {
  const bool weightless = b.scene().gravity_kind == ir::GravityKind::none, springs = b.tree().any_spring();
  if (weightless && !springs) return;  // a new workspace has it: zero
  const int strained = springs ? spring_energy(b) : -1;
  if (weightless) return b.result({array, ir::Layout::base, strained});
  const int first = first_moments(b), mass = composite_mass(b);
  const int energy = b.role({"potential_energy", "U", "U", "J", Shape::scalar});
  SweepBuilder s = b.sweep_of_base("height", "U = -gravity.(m x + X h)");
  const Vec3 in_base = s.gravity_in_base(), h = s.own3(first), in_world = s.gravity_in_world(), x = s.base_position();
  const Sym turned = dot(in_base, h), lowered = dot(in_world, x), moved = s.own(mass) * lowered;
  const Sym height = -(moved + turned);
  s.store(energy, springs ? height + s.own(strained) : height);
  b.result({array, ir::Layout::base, energy});
}

}  // namespace dalembert::passes
