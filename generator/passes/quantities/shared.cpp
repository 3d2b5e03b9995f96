#include "passes/quantities/shared.hpp"

#include "passes/joints.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::Shape;

namespace {

Mat3 rotation_from(const Vec3& x, const Vec3& y, const Vec3& z) { return from_columns(x, y, z); }

// Begins the names of what a fixed base has beside the cheapest.
std::string prefix(const Builder& b, Frame frame) { return frame == Frame::base && b.moves_reference() ? "ground_" : ""; }

}  // namespace

Twist unit_twist(SweepBuilder& s, int coordinate) {
  Twist unit{s.zero(), s.zero()};
  (coordinate < 3 ? unit.linear : unit.angular)[static_cast<std::size_t>(coordinate % 3)] = s.constant(1);
  return unit;
}

Poses poses(Builder& b, Frame frame) {
  const std::string in = prefix(b, frame);
  // The axes one after another: the third is the joint's.
  const Poses r{b.role({in + "rotation", "R", "R, column by column", "", Shape::matrix}),
                b.role({in + "position", "p", "p, the origin", "m", Shape::vector}),
                b.role({in + "joint_linear", "J", "J, motion subspace in base axes: linear part", "m", Shape::vector}),
                b.role({in + "joint_angular", "Jw", "J, motion subspace in base axes: angular part", "", Shape::vector}),
                b.role({in + "velocity", "V", "V = [u; w]", "m/s, rad/s", Shape::wrench}),
                b.role({in + "joint_rate", "dJ", "dJ", "m/s, rad/s", Shape::wrench})};
  if (b.has(in + "poses")) return r;
  SweepBuilder base = b.sweep_of_base(in + "base_pose", "R = 1, p = 0, V; J = 1, dJ = ad(V) J");
  const Twist v = base.base_twist();
  for (int i = 0; i < 9; ++i) base.store(r.rotation, i, base.constant(i % 4 == 0 ? 1 : 0));
  base.store(r.position, base.zero());
  base.store(r.velocity, v);
  for (int j = 0; j < b.base_coordinates(); ++j) {
    const Twist unit = unit_twist(base, j);
    base.store(r.joint_linear, unit.linear, 0, j);
    base.store(r.joint_angular, unit.angular, 0, j);
    base.store(r.joint_rate, joint_twist_rate(v, unit), j);
  }

  SweepBuilder s = b.sweep(in + "poses", "R = Rp Rk Rz(q), p = pp + Rp pk, J = [p x z; z], V = Vp + J dq, dJ = ad(Vp) J",
                           Direction::outwards);
  const Vec3 pz = s.carried3(r.rotation, 6), py = s.carried3(r.rotation, 3), px = s.carried3(r.rotation, 0);
  const Pose parent{rotation_from(px, py, pz), s.carried3(r.position)};
  const bool reference = in.empty();
  const BodyConstants c = s.body(reference);
  const Pose here = pose(parent, c, s.position(reference));
  const Twist joint = joint_twist(here, c);
  const Twist above{s.carried3(r.velocity, 0), s.carried3(r.velocity, 3)};
  // Axes of a joint with a quaternion turn with the link, as if their body were the link's parent.
  Twist before = above, velocity;
  if (b.tree().any_quaternion()) {
    const Vec3 turning = here.rotation * s.parameter3(joint_twist_p + 3), sliding = here.rotation * s.parameter3(joint_twist_p),
               lever = cross(here.position, turning);
    before = {above.linear + sliding + lever, above.angular + turning};
    const Sym rate = s.rate();
    velocity = body_twist(before, joint, s.parameter(moves_p) * rate);
  } else {
    velocity = body_twist(above, joint, s.rate());
  }
  for (int i = 0; i < 3; ++i) s.store(r.rotation, column(here.rotation, static_cast<std::size_t>(i)), 3 * i);
  s.store(r.position, here.position);
  s.store(r.joint_linear, joint.linear);
  s.store(r.joint_angular, joint.angular);
  s.store(r.velocity, velocity);
  s.store(r.joint_rate, joint_twist_rate(before, joint));
  if (!reference || !b.chooses_reference()) return r;
  SweepBuilder back = s.back();
  const Vec3 bz = back.carried3(r.rotation, 6), by = back.carried3(r.rotation, 3), bx = back.carried3(r.rotation, 0);
  const Pose below{rotation_from(bx, by, bz), back.carried3(r.position)};
  const BodyConstants k = back.body(true);
  const Pose above_it = pose_of_parent(below, k, back.position(true));
  SweepBuilder at_reference = back.at_reference();
  for (int i = 0; i < 9; ++i) {
    back.store(r.rotation, i, above_it.rotation[static_cast<std::size_t>(i % 3)][static_cast<std::size_t>(i / 3)]);
    at_reference.store(r.rotation, i, back.constant(i % 4 == 0 ? 1 : 0));
  }
  back.store(r.position, above_it.position);
  at_reference.store(r.position, back.zero());
  return r;
}

Pose pose_of(SweepBuilder& s, const Poses& r) {
  const Vec3 z = s.own3(r.rotation, 6), y = s.own3(r.rotation, 3), x = s.own3(r.rotation, 0);
  return {rotation_from(x, y, z), s.own3(r.position)};
}

Twist joint_of(SweepBuilder& s, const Poses& r) { return {s.own3(r.joint_linear), s.own3(r.joint_angular)}; }

Twist velocity_of(SweepBuilder& s, const Poses& r) { return {s.own3(r.velocity, 0), s.own3(r.velocity, 3)}; }

int composite_mass(Builder& b) {
  const int mass = b.role({"composite_mass", "m", "mass of the subtree", "kg", Shape::scalar});
  if (b.has("masses")) return mass;
  SweepBuilder s = b.sweep("masses", "m of the subtree", Direction::inwards);
  const Sym below = s.carried(mass), total = s.parameter(mass_p) + below;
  s.store(mass, total);
  s.hand_on(mass, 0, total);
  return mass;
}

namespace {

SweepBuilder accumulate(Builder& b, const std::string& name, const std::string& what) {
  return b.sweep(name, what + " summed over the subtree", Direction::inwards);
}

// Of each of the body's numbers the sum over its subtree.
void add_up(SweepBuilder& s, int from, int to, Shape shape) {
  for (int i = 0; i < ir::components(shape); ++i) {
    const Sym below = s.carried(from, i), sum = s.own(from, i) + below;
    s.store(to, i, sum);
    s.hand_on(from, i, sum);
  }
}

}  // namespace

BodyAndSubtree body_and_subtree_sums(Builder& b, Frame frame) {
  const Poses p = poses(b, frame);
  const std::string in = prefix(b, frame);
  const SumRoles own{b.role({in + "first", "hk", "h of the body", "kg m", Shape::vector}),
                     b.role({in + "second", "Sk", "S of the body: xx xy xz yy yz zz", "kg m^2", Shape::symmetric}),
                     b.role({in + "momentum", "Pk", "P of the body", "kg m/s", Shape::vector}),
                     b.role({in + "bias_block", "Dk", "D of the body, row by row", "kg m^2/s", Shape::matrix})};
  const SumRoles total{b.role({in + "subtree_first", "h", "h", "kg m", Shape::vector, own.first}),
                       b.role({in + "subtree_second", "S", "S: xx xy xz yy yz zz", "kg m^2", Shape::symmetric, own.second}),
                       b.role({in + "subtree_momentum", "P", "P", "kg m/s", Shape::vector, own.momentum}),
                       b.role({in + "subtree_bias_block", "D", "D, row by row", "kg m^2/s", Shape::matrix, own.bias})};
  if (b.has(in + "moments")) return {own, total};
  SweepBuilder m = b.sweep(in + "moments", "h = R hk + m p, S = R Sk R' + R hk p' + p (R hk)' + m p p'", Direction::anywhere);
  const BodyConstants c = m.body();
  Sums s = moments(pose_of(m, p), c);
  const Sym half_trace = b.half_traces() ? c.half_trace : m.constant(0);
  add_velocity(s, velocity_of(m, p), c.mass, half_trace);
  m.store(own.first, s.first);
  for (int i = 0; i < 6; ++i) m.store(own.second, i, s.second[static_cast<std::size_t>(i)]);
  m.store(own.momentum, s.momentum);
  for (int i = 0; i < 3; ++i) m.store(own.bias, s.bias[static_cast<std::size_t>(i)], 3 * i);
  if (in.empty() && b.chooses_reference()) m.leave_first_to_its_joint();

  SweepBuilder a = accumulate(b, in + "accumulate", "h, S, P, D");
  add_up(a, own.first, total.first, Shape::vector);
  add_up(a, own.second, total.second, Shape::symmetric);
  add_up(a, own.momentum, total.momentum, Shape::vector);
  add_up(a, own.bias, total.bias, Shape::matrix);
  return {own, total};
}

BodyAndSubtree christoffel_sums(Builder& b, Frame frame) {
  BodyAndSubtree all = body_and_subtree_sums(b, frame);
  if (!b.half_traces()) return all;
  const std::string in = prefix(b, frame) + "christoffel_";
  all.body.bias = b.role({in + "block", "Dk", "D of the body, row by row, without t", "kg m^2/s", Shape::matrix});
  all.subtree.bias = b.role({in + "subtree_block", "D", "D, row by row, without t", "kg m^2/s", Shape::matrix, all.body.bias});
  if (b.has(in + "moments")) return all;
  const Poses p = poses(b, frame);
  SweepBuilder m = b.sweep(in + "moments", "D of the body without t", Direction::anywhere);
  const BodyConstants c = m.body();
  Sums s = moments(pose_of(m, p), c);
  const Sym without_trace = m.constant(0);
  add_velocity(s, velocity_of(m, p), c.mass, without_trace);
  for (int i = 0; i < 3; ++i) m.store(all.body.bias, s.bias[static_cast<std::size_t>(i)], 3 * i);
  SweepBuilder a = accumulate(b, in + "accumulate", "D without t");
  add_up(a, all.body.bias, all.subtree.bias, Shape::matrix);
  return all;
}

SumRoles subtree_sums(Builder& b, Frame frame) { return body_and_subtree_sums(b, frame).subtree; }

Sums sums_of(SweepBuilder& s, const SumRoles& r) {
  Sums sums;
  sums.first = s.own3(r.first);
  sums.momentum = s.own3(r.momentum);
  sums.bias = s.own9(r.bias);
  for (int i = 0; i < 6; ++i) sums.second[static_cast<std::size_t>(i)] = s.own(r.second, i);
  return sums;
}

ForceRoles forces(Builder& b, Frame frame) {
  const Poses p = poses(b, frame);
  const std::string in = prefix(b, frame);
  const int mass = composite_mass(b);
  const SumRoles sums = subtree_sums(b, frame);
  const ForceRoles r{b.role({in + "inertia_force", "F", "F = A* J", "kg m, kg m^2 per unit of the coordinate", Shape::wrench}),
                     b.role({in + "bias_force", "G", "G = A* dJ + B* J", "kg m/s, kg m^2/s", Shape::wrench}),
                     b.role({in + "transposed", "H", "H = P x Jv + D' Jw", "kg m^2/s", Shape::vector})};
  if (b.has(in + "forces")) return r;
  const auto add = [&](SweepBuilder& s, const Twist& joint, const Twist& joint_rate, int coordinate) {
    const Sym m = s.own(mass);
    const Sums subtree = sums_of(s, sums);
    const Twist f = apply_inertia(m, subtree, joint), g = apply_inertia(m, subtree, joint_rate), h = apply_bias(subtree, joint);
    s.store(r.inertia, f, coordinate);
    s.store(r.bias, Twist{g.linear + h.linear, g.angular + h.angular}, coordinate);
    if (coordinate < 0) s.store(r.transposed, apply_bias_transposed(subtree, joint));
  };
  SweepBuilder s = b.sweep(in + "forces", "F = A* J, G = A* dJ + B* J, H = P x Jv + D' Jw", Direction::anywhere);
  const Twist joint_rate{s.own3(p.joint_rate, 0), s.own3(p.joint_rate, 3)};
  add(s, joint_of(s, p), joint_rate, -1);
  if (b.base_coordinates() == 0) return r;
  SweepBuilder base = b.sweep_of_base(in + "base_forces", "M_BB = A*, C_BB = A* ad(V) + B*");
  for (int j = 0; j < b.base_coordinates(); ++j) {
    const Twist unit = unit_twist(base, j);
    add(base, unit, joint_twist_rate(velocity_of(base, p), unit), j);
  }
  return r;
}

bool bias_is_gravity(const Builder& b) { return b.scene().rates_zero && !b.tree().any_spring(); }

GravityRoles gravity_torques(Builder& b) {
  const int mass = composite_mass(b);
  const int down = b.role({"down", "down", "gravity along the body's axes", "m/s^2", Shape::vector});
  const int first = b.role({"gravity_first", "h", "h of the subtree along the body's axes", "kg m", Shape::vector});
  const int torque = b.role({"gravity_torque", "g", "g", "N m or N", Shape::scalar});
  const GravityRoles r{torque, mass, first, down};
  if (b.has("falling")) return r;
  SweepBuilder root = b.sweep_of_base("base_falling", "gravity along the base's axes");
  root.store(down, root.gravity_in_base());

  SweepBuilder out = b.sweep("falling", "down = (Rk Rz(q))' down_p", Direction::outwards);
  const Vec3 above = out.carried3(down);
  const JointPosition position = out.position();
  out.store(down, to_child(out.body(), position, above));

  SweepBuilder in =
      b.sweep("weights", "g = " + either_way("-(h x down)_z", "-m down_z") + "; h_p += Rk Rz(q) h + m p", Direction::inwards);
  const BodyConstants k = in.body();
  const JointPosition q = in.position();
  const Sym m = in.own(mass);
  const Vec3 d = in.own3(down), below = in.carried3(first), h = in.parameter3(first_p) + below;
  in.store(first, h);
  const Sym weight = m * d[2], moment = difference_of_products(h[0], d[1], h[1], d[0]);
  in.store(torque, -sum_of_products(k.turning, moment, k.sliding, weight));
  const Vec3 origin = k.translation + q.displacement * column(k.rotation, 2);
  const Vec3 moved = m * origin;
  in.hand_on(first, to_parent(k, q, h) + moved);
  if (b.base_coordinates() == 0) return r;

  SweepBuilder base = b.sweep_of_base("base_weight", "g = -[m down; h x down]");
  const Vec3 g = base.own3(down), turning = cross(base.own3(first), g);
  for (int j = 0; j < 3; ++j) {
    const auto at = static_cast<std::size_t>(j);
    base.store(torque, 0, -(base.own(mass) * g[at]), j);
    base.store(torque, 0, -turning[at], j + 3);
  }
  return r;
}

int gravity_in_reference(Builder& b) {
  const int down = gravity_torques(b).down;
  const int role = b.role({"reference_down", "G", "gravity along the frame of reference", "m/s^2", Shape::vector});
  if (b.has("reference_gravity")) return role;
  SweepBuilder base = b.sweep_of_base("base_reference_gravity", "G = 0");
  base.store(role, base.zero());
  SweepBuilder s = b.sweep("reference_gravity", "G = Gp", Direction::outwards);
  s.store(role, s.carried3(role));
  SweepBuilder back = s.back();
  back.store(role, back.carried3(role));
  back.at_reference().store(role, back.carried3(down));
  return role;
}

}  // namespace dalembert::passes
