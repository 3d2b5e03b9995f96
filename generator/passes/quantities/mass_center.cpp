#include "passes/quantities/mass_center.hpp"

#include "passes/joints.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::Shape;

int first_moments(Builder& b) {
  const int mass = composite_mass(b);
  const int first = b.role({"first_moment", "h", "h of the subtree along the body's axes", "kg m", Shape::vector});
  if (b.has("first_moments")) return first;
  SweepBuilder in = b.sweep("first_moments", "h_p += Rk Rz(q) h + m p", Direction::inwards);
  const BodyConstants k = in.body();
  const JointPosition q = in.position();
  const Vec3 below = in.carried3(first), h = in.parameter3(first_p) + below;
  in.store(first, h);
  const Vec3 origin = k.translation + q.displacement * column(k.rotation, 2), moved = in.own(mass) * origin;
  in.hand_on(first, to_parent(k, q, h) + moved);
  return first;
}

int inverse_mass(Builder& b) {
  const int mass = composite_mass(b);
  const int inverse = b.role({"inverse_mass", "im", "one over the robot's mass", "1/kg", Shape::scalar});
  if (b.has("inverse_mass")) return inverse;
  SweepBuilder s = b.sweep_of_base("inverse_mass", "1/m");
  const Sym one = s.constant(1), total = s.own(mass);
  s.store(inverse, Sym{one.graph, one.graph->divide(one.id, total.id)});
  return inverse;
}

int world_axes(Builder& b) {
  const int axes = b.role({"world_axes", "X", "X, the body's axes in the world, one after another", "", Shape::matrix});
  if (b.has("world_axes")) return axes;
  const auto store = [&](SweepBuilder& s, const Mat3& m) {
    for (int i = 0; i < 3; ++i) s.store(axes, column(m, static_cast<std::size_t>(i)), 3 * i);
  };
  SweepBuilder root = b.sweep_of_base("base_axes", "X, the base's axes in the world");
  store(root, root.base_axes());
  SweepBuilder out = b.sweep("world_axes", "X = Xp Rk Rz(q)", Direction::outwards);
  const Vec3 z = out.carried3(axes, 6), y = out.carried3(axes, 3), x = out.carried3(axes, 0);
  const BodyConstants k = out.body();
  const Mat3 placed = from_columns(x, y, z) * k.rotation;
  store(out, turned(placed, out.position()));
  return axes;
}

int center_columns(Builder& b) {
  const int first = first_moments(b), mass = composite_mass(b), inverse = inverse_mass(b), axes = world_axes(b);
  const int columns = b.role({"center_column", "Jc", "the centre of mass's velocity", "m, 1", Shape::vector});
  if (b.has("center_columns")) return columns;
  SweepBuilder s = b.sweep("center_columns", "Jc = " + either_way("X (z x h)/M", "X z m/M"), Direction::anywhere);
  const Sym part = s.of(-1, inverse);
  const BodyConstants k = s.body();
  const Sym turning = part * k.turning, weight = k.sliding * s.own(mass), sliding = part * weight;
  const Sym along_y = turning * s.own(first, 0), along_x = turning * s.own(first, 1);
  const Vec3 z = sliding * s.own3(axes, 6), y = along_y * s.own3(axes, 3), x = along_x * s.own3(axes, 0);
  s.store(columns, y - x + z);
  if (b.base_coordinates() == 0) return columns;
  SweepBuilder base = b.sweep_of_base("base_center_columns", "Jc = X [1, -[h]/M]");
  const Vec3 moment = base.own3(first), h = base.own(inverse) * moment;
  const Vec3 bz = base.own3(axes, 6), by = base.own3(axes, 3), bx = base.own3(axes, 0);
  const Mat3 x_base = from_columns(bx, by, bz);
  for (std::size_t j = 0; j < 3; ++j) {
    Vec3 unit = base.zero();
    unit[j] = base.constant(1);
    base.store(columns, column(x_base, j), 0, static_cast<int>(j));
    base.store(columns, x_base * cross(unit, h), 0, static_cast<int>(j) + 3);
  }
  return columns;
}

}  // namespace dalembert::passes
