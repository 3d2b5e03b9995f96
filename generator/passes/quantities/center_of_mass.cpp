// c = x + X h/m: x and X the base's position and axes in the world, h the robot's first moment along them.
#include "passes/quantities/mass_center.hpp"
#include "passes/quantities/quantities.hpp"

namespace dalembert::passes {

using ir::Shape;

void describe_center_of_mass(Builder& b, int array) {
  const int first = first_moments(b), inverse = inverse_mass(b);
  const int center = b.role({"center", "c", "the centre of mass in the world", "m", Shape::vector});
  SweepBuilder s = b.sweep_of_base("center", "c = x + X h/m");
  const Vec3 h = s.own3(first), lever = s.own(inverse) * h;
  const Vec3 turned = s.base_axes() * lever;
  s.store(center, s.base_position() + turned);
  b.result({array, ir::Layout::base, center});
}

}  // namespace dalembert::passes
