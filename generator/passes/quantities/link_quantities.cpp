// Quantities of a link's frame. Everything is a twist or a sum along the base's axes and about its origin, brought to the axes
// asked for: X' and the lever to the link's origin (link axes), or the base's axes in the world.
#include <map>

#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::LinkQuantity;
using ir::Shape;

namespace {

// Where twists end up: see ir/link_quantities.def.
enum class Axes { link, world, mixed };

// What says link axes does not depend on the first joints of a fixed base.
Frame frame_of(Axes axes) { return axes == Axes::link ? Frame::cheapest : Frame::base; }

void store_columns(SweepBuilder& s, int role, const Mat3& m) {
  for (int l = 0; l < 3; ++l) s.store(role, column(m, static_cast<std::size_t>(l)), 3 * l);
}

// Brings a twist from the base's axes and origin to where it is asked for.
class Target {
 public:
  Target(Builder& b, const LinkFrame& link, Axes axes)
      : axes_(axes),
        link_(link_place(b, link, frame_of(axes))),
        base_(axes == Axes::link ? LinkPlace{-1, -1} : base_in_world(b)) {}

  Vec3 origin(SweepBuilder& s) const { return s.of3(-1, link_.origin); }
  Twist moved(SweepBuilder& s, const Twist& twist) const {
    if (axes_ == Axes::world) {
      const Mat3 to_world = three_columns(s, -1, base_.axes);
      const Vec3 angular = to_world * twist.angular, turned = to_world * twist.linear;
      const Vec3 lever = cross(s.of3(-1, base_.origin), angular);
      return {turned + lever, angular};
    }
    const Vec3 lever = cross(twist.angular, origin(s)), linear = twist.linear + lever;
    return turned(s, {linear, twist.angular});
  }
  // From the base's axes, at the same point.
  Twist turned(SweepBuilder& s, const Twist& twist) const {
    const Mat3 m = axes_ == Axes::link ? transpose(three_columns(s, -1, link_.axes)) : three_columns(s, -1, base_.axes);
    const Vec3 angular = m * twist.angular, linear = m * twist.linear;
    return {linear, angular};
  }

 private:
  Axes axes_;
  LinkPlace link_, base_;
};

std::string suffix(Axes axes) { return axes == Axes::link ? "_" : axes == Axes::world ? "_world_" : "_mixed_"; }

void describe_pose(Builder& b, const LinkFrame& link, int array) {
  const LinkPlace at = link_place(b, link, Frame::base), base = base_in_world(b);
  const int axes = b.role({"world_axes_" + link.name, "Xw", "axes of link " + link.name + " in the world", "", Shape::matrix});
  const int origin =
      b.role({"world_origin_" + link.name, "xw", "origin of link " + link.name + " in the world", "m", Shape::vector});
  SweepBuilder s = b.sweep_of_base("pose_" + link.name, "Xw = X0 X, xw = x0 + X0 x");
  const Mat3 own = three_columns(s, -1, at.axes), to_world = three_columns(s, -1, base.axes);
  store_columns(s, axes, to_world * own);
  const Vec3 offset = to_world * s.of3(-1, at.origin);
  s.store(origin, s.of3(-1, base.origin) + offset);
  b.result({array, ir::Layout::base, axes});
  b.result({array, ir::Layout::base, origin, 9});
}

void describe_twist(Builder& b, const LinkFrame& link, int array) {
  const Poses p = poses(b);
  const Target target(b, link, Axes::link);
  const int twist = b.role({"velocity_" + link.name, "Vl", "twist of link " + link.name, "m/s, rad/s", Shape::wrench});
  SweepBuilder s = b.sweep_of_base("velocity_" + link.name, "V_l = X' [u + w x x; w]");
  const Vec3 linear = s.of3(link.body, p.velocity, 0), angular = s.of3(link.body, p.velocity, 3);
  s.store(twist, target.moved(s, {linear, angular}));
  b.result({array, ir::Layout::base, twist});
}

void describe_jacobian(Builder& b, const LinkFrame& link, Axes axes, int array) {
  const Poses p = poses(b, frame_of(axes));
  const Target target(b, link, axes);
  const std::string name = suffix(axes) + link.name;
  const int columns = b.role({"twist" + name, "Jl", "twist of link " + link.name, "m", Shape::wrench});
  const char* equation = axes == Axes::link    ? "J_l = X' [Jv + Jw x x; Jw]"
                         : axes == Axes::world ? "J_l = [X0 Jv + x0 x X0 Jw; X0 Jw]"
                                               : "J_l = X0 [Jv + Jw x x; Jw]";
  const ir::BodySet moving = ir::BodySet::above(link.body);
  if (link.body >= 0) {
    SweepBuilder s = b.sweep("columns" + name, equation, Direction::anywhere, moving);
    s.store(columns, target.moved(s, joint_of(s, p)));
  }
  if (b.base_coordinates() > 0) {
    SweepBuilder base = b.sweep_of_base("base_columns" + name, equation);
    for (int j = 0; j < 6; ++j) {
      Twist unit{base.zero(), base.zero()};
      (j < 3 ? unit.linear : unit.angular)[static_cast<std::size_t>(j % 3)] = base.constant(1);
      base.store(columns, target.moved(base, unit), j);
    }
  }
  b.result({array, ir::Layout::columns, columns, 0, moving});
}

void describe_acceleration_bias(Builder& b, const LinkFrame& link, Axes axes, int array) {
  const Frame frame = frame_of(axes);
  const Poses p = poses(b, frame);
  const int of_bodies = bias_accelerations(b, frame == Frame::base);
  const Target target(b, link, axes);
  const std::string name = suffix(axes) + link.name;
  const int bias = b.role({"acceleration" + name, "dVl", "dJ/dt v of link " + link.name, "m/s^2, rad/s^2", Shape::wrench});
  const char* equation = axes == Axes::link    ? "dV_l = X' [a + alpha x x; alpha]"
                         : axes == Axes::world ? "dV_l = [X0 a + x0 x X0 alpha; X0 alpha]"
                                               : "dV_l = X0 [a + alpha x x + w x (u + w x x); alpha]";
  SweepBuilder s = b.sweep_of_base("acceleration" + name, equation);
  const Twist acceleration{s.of3(link.body, of_bodies, 0), s.of3(link.body, of_bodies, 3)};
  if (axes != Axes::mixed) {
    s.store(bias, target.moved(s, acceleration));
  } else {
    const Vec3 u = s.of3(link.body, p.velocity, 0), w = s.of3(link.body, p.velocity, 3), x = target.origin(s);
    const Vec3 velocity = u + cross(w, x), centripetal = cross(w, velocity), tangential = cross(acceleration.angular, x);
    s.store(bias, target.turned(s, {acceleration.linear + tangential + centripetal, acceleration.angular}));
  }
  b.result({array, ir::Layout::base, bias});
}

}  // namespace

LinkPlace base_in_world(Builder& b) {
  const LinkPlace base{b.role({"world_base_axes", "X", "the base's axes in the world, one after another", "", Shape::matrix}),
                       b.role({"world_base_origin", "x", "the base's origin in the world", "m", Shape::vector})};
  if (b.has("world_base")) return base;
  SweepBuilder s = b.sweep_of_base("world_base", "the base's axes and origin in the world");
  store_columns(s, base.axes, s.base_axes());
  s.store(base.origin, s.base_position());
  return base;
}

// The sum of dJ q̇ above it.
int bias_accelerations(Builder& b, bool along_base) {
  const Frame frame = along_base ? Frame::base : Frame::cheapest;
  const Poses p = poses(b, frame);
  const std::string in = frame == Frame::base && b.moves_reference() ? "ground_" : "";
  const int acceleration = b.role({in + "bias_acceleration", "dV", "dV where dv = 0", "m/s^2, rad/s^2", Shape::wrench});
  if (b.has(in + "bias_accelerations")) return acceleration;
  SweepBuilder root = b.sweep_of_base(in + "base_bias_acceleration", "dV = 0");
  root.store(acceleration, Twist{root.zero(), root.zero()});
  SweepBuilder s = b.sweep(in + "bias_accelerations", "dV = dVp + dJ dq", Direction::outwards);
  const Sym rate = s.rate();
  for (int i = 0; i < 6; ++i) {
    const Sym own = s.own(p.joint_rate, i) * rate;
    s.store(acceleration, i, s.carried(acceleration, i) + own);
  }
  return acceleration;
}

Mat3 three_columns(SweepBuilder& s, int body, int role) {
  const Vec3 z = s.of3(body, role, 6), y = s.of3(body, role, 3), x = s.of3(body, role, 0);
  return from_columns(x, y, z);
}

// X = R Rl, x = p + R pl: the link in the frame of the poses.
LinkPlace link_place(Builder& b, const LinkFrame& link, Frame frame) {
  const Poses p = poses(b, frame);
  const std::string name = (frame == Frame::base && b.moves_reference() ? "ground_" : "") + link.name;
  const LinkPlace at{b.role({"axes_" + name, "X", "axes of link " + link.name, "", Shape::matrix}),
                     b.role({"origin_" + name, "x", "origin of link " + link.name, "m", Shape::vector})};
  if (b.has("frame_" + name)) return at;
  SweepBuilder s = b.sweep_of_base("frame_" + name, "X = R Rl, x = p + R pl");
  const Mat3 rotation = three_columns(s, link.body, p.rotation), link_rotation = s.constant(link.rotation);
  store_columns(s, at.axes, rotation * link_rotation);
  const Vec3 offset = rotation * s.constant(link.translation);
  s.store(at.origin, s.of3(link.body, p.position) + offset);
  return at;
}

void describe_link_quantity(Builder& b, const LinkFrame& link, LinkQuantity quantity, int array) {
  switch (quantity) {
    case LinkQuantity::pose: return describe_pose(b, link, array);
    case LinkQuantity::twist: return describe_twist(b, link, array);
    case LinkQuantity::jacobian: return describe_jacobian(b, link, Axes::link, array);
    case LinkQuantity::jacobian_world: return describe_jacobian(b, link, Axes::world, array);
    case LinkQuantity::jacobian_mixed: return describe_jacobian(b, link, Axes::mixed, array);
    case LinkQuantity::acceleration_bias: return describe_acceleration_bias(b, link, Axes::link, array);
    case LinkQuantity::acceleration_bias_world: return describe_acceleration_bias(b, link, Axes::world, array);
    case LinkQuantity::acceleration_bias_mixed: return describe_acceleration_bias(b, link, Axes::mixed, array);
  }
}

}  // namespace dalembert::passes
