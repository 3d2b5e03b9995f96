// A, with h = A v the momentum of the whole robot: linear, and angular about its centre of mass, along the world's axes (Orin,
// Goswami and Lee 2013). A column is F = A* J of its coordinate, moved from the base's origin.
#include "passes/quantities/mass_center.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::Shape;

void describe_momentum_matrix(Builder& b, int array) {
  const SumRoles sums = subtree_sums(b, Frame::base);
  const int force = forces(b, Frame::base).inertia, inverse = inverse_mass(b);
  const int lever =
      b.role({"center_lever", "r", "from the base's origin to the centre of mass, base axes", "m", Shape::vector});
  const int axes = b.role({"base_axes", "X", "the base's axes in the world, one after another", "", Shape::matrix});
  const int column = b.role({"momentum_column", "A", "A", "kg, kg m, kg m^2", Shape::wrench});

  SweepBuilder root = b.sweep_of_base("center_lever", "r = h/m");
  const Vec3 h = root.own3(sums.first);
  root.store(lever, root.own(inverse) * h);
  SweepBuilder turn = b.sweep_of_base("momentum_axes", "X, the base's axes in the world");
  const Mat3 x = turn.base_axes();
  for (int i = 0; i < 3; ++i) turn.store(axes, passes::column(x, static_cast<std::size_t>(i)), 3 * i);

  const auto add = [&](SweepBuilder& s, const Twist& wrench, int coordinate) {
    const Vec3 az = s.of3(-1, axes, 6), ay = s.of3(-1, axes, 3), ax = s.of3(-1, axes, 0);
    const Mat3 to_world = from_columns(ax, ay, az);
    const Vec3 moved = cross(s.of3(-1, lever), wrench.linear), about_center = wrench.angular - moved;
    const Vec3 angular = to_world * about_center, linear = to_world * wrench.linear;
    s.store(column, Twist{linear, angular}, coordinate);
  };
  SweepBuilder s = b.sweep("momentum_columns", "A = [X f; X (n - r x f)], F = [f; n]", Direction::anywhere);
  add(s, {s.own3(force, 0), s.own3(force, 3)}, -1);
  if (b.base_coordinates() > 0) {
    SweepBuilder base = b.sweep_of_base("base_momentum_columns", "A = [X m, -X [h]; 0, X (I + [r][h])]");
    const Sym mass = base.own(composite_mass(b));
    const Sums whole = sums_of(base, sums);
    for (std::size_t j = 0; j < 3; ++j) {
      Twist unit{base.zero(), base.zero()};
      unit.angular[j] = base.constant(1);
      const Vec3 axis = base.of3(-1, axes, 3 * static_cast<int>(j));
      base.store(column, Twist{mass * axis, base.zero()}, static_cast<int>(j));
      add(base, apply_inertia(mass, whole, unit), static_cast<int>(j) + 3);
    }
  }
  b.result({array, ir::Layout::columns, column});
}

}  // namespace dalembert::passes
