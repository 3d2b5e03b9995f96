// Recursive Newton-Euler in body axes (Featherstone 2008, ch. 5).
#include "passes/joints.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::Shape;

namespace {

struct MotionRoles {
  int angular, angular_acceleration, acceleration;
};

Motion motion_of(SweepBuilder& s, const MotionRoles& r) {
  return {s.own3(r.angular), s.own3(r.angular_acceleration), s.own3(r.acceleration)};
}

void store(SweepBuilder& s, const MotionRoles& r, const Motion& m) {
  s.store(r.angular, m.angular);
  s.store(r.angular_acceleration, m.angular_acceleration);
  s.store(r.acceleration, m.acceleration);
}

}  // namespace

NewtonEuler newton_euler(Builder& b, Driven driven) {
  const bool accelerated = driven == Driven::accelerated;
  const bool gravity_acts = b.scene().gravity_kind != ir::GravityKind::none;
  const bool weightless = driven == Driven::weightless && gravity_acts;
  // A function may give what it finds at rest beside what it is given accelerations for.
  const bool both =
      accelerated &&
      (b.computes(ir::Quantity::bias) ||
       ((b.computes(ir::Quantity::momentum_bias) || b.computes(ir::Quantity::center_of_mass_bias)) && !gravity_acts));
  const std::string motions = weightless ? "weightless_" : both ? "accelerated_" : "";
  const MotionRoles motion{
      b.role({motions + "angular", "w", "w along the body's axes", "rad/s", Shape::vector}),
      b.role({motions + "angular_acceleration", "alpha", "dw along the body's axes", "rad/s^2", Shape::vector}),
      b.role({motions + "acceleration", "a",
              weightless ? "the origin's acceleration, along the body's axes"
                         : "the origin's acceleration less gravity, along the body's axes",
              "m/s^2", Shape::vector})};
  const int wrench = b.role({motions + "wrench", "fk", "f, n of the body along its axes", "N, N m", Shape::wrench});
  const int total =
      b.role({motions + "subtree_wrench", "f", "f, n of the subtree along the body's axes", "N, N m", Shape::wrench, wrench});
  const char* what = accelerated ? "M a + C v + g" : weightless ? "C v" : "C v + g";
  const int torque = b.role(
      {motions + (accelerated ? "torque" : "bias_torque"), accelerated ? "tau" : "bias", what, "N m or N", Shape::scalar});

  const NewtonEuler roles{motion.angular, motion.angular_acceleration, motion.acceleration, torque, total};
  if (b.has(motions + "motion")) return roles;
  SweepBuilder root = b.sweep_of_base(motions + "base_motion", accelerated  ? "w, dw, a = du + w x u - gravity"
                                                               : weightless ? "w, dw = 0, a = w x u"
                                                                            : "w, dw = 0, a = w x u - gravity");
  const Twist v = root.base_twist(), dv = accelerated ? root.base_acceleration() : Twist{root.zero(), root.zero()};
  const Vec3 gravity = weightless ? root.zero() : root.gravity_in_base(), centripetal = cross(v.angular, v.linear);
  store(root, motion, {v.angular, dv.angular, accelerated ? dv.linear + centripetal - gravity : centripetal - gravity});

  SweepBuilder out = b.sweep(motions + "motion", "w, dw and a of the body along its own axes", Direction::outwards);
  const Motion parent{out.carried3(motion.angular), out.carried3(motion.angular_acceleration),
                      out.carried3(motion.acceleration)};
  const BodyConstants body = out.body();
  Motion state;
  if (b.tree().any_quaternion()) {
    const Twist joint = out.joint_twist();
    state = propagate(parent, body, out.position(), joint);
  } else {
    const Sym rate = out.rate();
    state = propagate(parent, body, out.position(), rate);
  }
  if (accelerated) accelerate(state, body, out.acceleration());
  store(out, motion, state);

  SweepBuilder wrenches =
      b.sweep(motions + "wrenches", "f = m a + dw x h + w x (w x h), n = h x a + I dw + w x I w", Direction::anywhere);
  const BodyConstants inertia = wrenches.body();
  const Force f = body_force(motion_of(wrenches, motion), inertia);
  wrenches.store(wrench, f.force, 0);
  wrenches.store(wrench, f.torque, 3);

  SweepBuilder in =
      b.sweep(motions + "torques", std::string(what) + " = " + either_way("n_z", "f_z") + "; f_p += R f, n_p += R n + p x R f",
              Direction::inwards);
  const BodyConstants k = in.body();
  const JointPosition q = in.position();
  const Vec3 force_below = in.carried3(wrench, 0), force = in.own3(wrench, 0) + force_below;
  const Vec3 torque_below = in.carried3(wrench, 3), turning = in.own3(wrench, 3) + torque_below;
  in.store(total, force, 0);
  in.store(total, turning, 3);
  const Sym rate = in.rate(), sign{rate.graph, rate.graph->sign(rate.id)}, friction = in.parameter(friction_p) * sign;
  const Sym damping = in.parameter(damping_p) * rate;
  Sym own = sum_of_products(k.turning, turning[2], k.sliding, force[2]) + damping + friction;
  if (b.tree().any_spring()) {
    const Sym rest = in.parameter(rest_p), strain = in.coordinate() - rest;
    own = own + in.parameter(stiffness_p) * strain;
  }
  if (accelerated) {
    const Sym acceleration = in.acceleration();
    own = own + in.parameter(armature_p) * acceleration;
  }
  in.store(torque, own);
  const Vec3 origin = k.translation + q.displacement * column(k.rotation, 2), moved = to_parent(k, q, force);
  in.hand_on(wrench, moved, 0);
  const Vec3 lever = cross(origin, moved);
  in.hand_on(wrench, to_parent(k, q, turning) + lever, 3);

  if (b.base_coordinates() > 0) {
    SweepBuilder base = b.sweep_of_base(motions + "base_wrench", std::string(what) + " = [f; n]");
    for (int j = 0; j < 6; ++j) base.store(torque, 0, base.own(total, j), j);
  }
  return roles;
}

}  // namespace dalembert::passes
