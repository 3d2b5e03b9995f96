// The body Jacobian of one link: the twist of its frame, in its own axes, per unit rate of every joint above it.
#include "ir/identifier.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::Shape;

void describe_link_jacobian(Builder& b, const LinkFrame& link, int array) {
  const Poses p = poses(b);
  const int axes = b.role({"axes_" + link.name, "X", "axes of link " + link.name, "", Shape::matrix});
  const int origin = b.role({"origin_" + link.name, "x", "origin of link " + link.name, "m", Shape::vector});
  const int columns = b.role({"twist_" + link.name, "Jl", "twist of link " + link.name, "m", Shape::wrench});

  SweepBuilder frame = b.sweep("frame_" + link.name, "X = R Rl, x = p + R pl", Direction::root);
  const Vec3 z = frame.of3(link.body, p.rotation, 6), y = frame.of3(link.body, p.rotation, 3),
             x = frame.of3(link.body, p.rotation, 0);
  const Mat3 rotation = from_columns(x, y, z), link_rotation = frame.constant(link.rotation);
  const Mat3 turned = rotation * link_rotation;
  for (int l = 0; l < 3; ++l) frame.store(axes, column(turned, static_cast<std::size_t>(l)), 3 * l);
  const Vec3 offset = rotation * frame.constant(link.translation);
  frame.store(origin, frame.of3(link.body, p.position) + offset);

  const auto add = [&](SweepBuilder& s, const Twist& joint, int coordinate) {
    const Mat3 to_link{s.of3(-1, axes, 0), s.of3(-1, axes, 3), s.of3(-1, axes, 6)};
    const Vec3 lever = cross(joint.angular, s.of3(-1, origin));
    const Vec3 angular = to_link * joint.angular, linear = to_link * (joint.linear + lever);
    s.store(columns, Twist{linear, angular}, coordinate);
  };
  SweepBuilder s = b.sweep("columns_" + link.name, "J_l = X' [Jv + Jw x x; Jw]", Direction::anywhere);
  s.only_above(link.body);
  add(s, joint_of(s, p), -1);
  if (b.floating()) {
    SweepBuilder base = b.sweep("base_columns_" + link.name, "J_l = X' [Jv + Jw x x; Jw]", Direction::root);
    for (int j = 0; j < 6; ++j) {
      Twist unit{base.zero(), base.zero()};
      (j < 3 ? unit.linear : unit.angular)[static_cast<std::size_t>(j % 3)] = base.constant(1);
      add(base, unit, j);
    }
  }
  b.result({array, ir::Layout::columns, columns, 0, link.body});
}

}  // namespace dalembert::passes
