// T = ½ Σ (m u·u + 2 h·(u × w) + w·I w), bodies along their own axes, and ½ armature q̇² of the joints.
#include "passes/quantities/quantities.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::Shape;

namespace {

// ½ w·I w with I = tr(S) 1 − S.
Sym rotational_energy(const BodyConstants& body, const Vec3& w) {
  const Vec3& half = body.half_second;
  const Sym xx = w[0] * w[0], yy = w[1] * w[1], zz = w[2] * w[2];
  const Sym about_x = half[0] * (yy + zz), about_y = half[1] * (xx + zz), about_z = half[2] * (xx + yy);
  const Sym products = sum_of_products(body.second[1], w[1], body.second[2], w[2]), yz = body.second[4] * w[1];
  const Sym with_z = yz * w[2], deviation = w[0] * products + with_z;
  return about_x + about_y + about_z - deviation;
}

Sym body_energy(SweepBuilder& s, const BodyConstants& body, const Twist& velocity) {
  const Vec3 &u = velocity.linear, &w = velocity.angular;
  const Sym rotational = rotational_energy(body, w), mixed = dot(body.first, cross(u, w));
  const Sym square = dot(u, u), half_mass = s.constant(0.5) * body.mass, linear = half_mass * square;
  return linear + mixed + rotational;
}

}  // namespace

void describe_kinetic_energy(Builder& b, int array) {
  if (b.scene().rates_zero) return;  // a new workspace has it: zero
  const int velocity = b.role({"body_velocity", "Vk", "u, w of the body along its axes", "m/s, rad/s", Shape::wrench});
  const int energy = b.role({"kinetic_energy", "T", "T of the subtree", "J", Shape::scalar});

  SweepBuilder root = b.sweep_of_base("base_velocity", "u, w along the base's axes");
  root.store(velocity, root.base_twist());

  SweepBuilder out = b.sweep("velocities", "w = (Rk Rz(q))' w_p + z dq, u = (Rk Rz(q))' (u_p + w_p x p)", Direction::outwards);
  const Twist parent{out.carried3(velocity, 0), out.carried3(velocity, 3)};
  const BodyConstants k = out.body();
  const JointPosition q = out.position();
  if (b.tree().any_quaternion()) {
    const Twist still = body_velocity(parent, k, q, out.constant(0)), own = out.joint_twist();
    out.store(velocity, Twist{still.linear + own.linear, still.angular + own.angular});
  } else {
    out.store(velocity, body_velocity(parent, k, q, out.rate()));
  }

  SweepBuilder in = b.sweep("energies", "T = T_below + (m u.u + 2 h.(u x w) + w.I w + armature dq^2)/2", Direction::inwards);
  const BodyConstants body = in.body();
  const Sym own = body_energy(in, body, {in.own3(velocity, 0), in.own3(velocity, 3)});
  const Sym rate = in.rate(), square = rate * rate, half_armature = in.parameter(half_armature_p);
  const Sym rotor = half_armature * square, below = in.carried(energy);
  const Sym total = own + rotor + below;
  in.store(energy, total);
  in.hand_on(energy, 0, total);
  b.result({array, ir::Layout::base, energy});
}

}  // namespace dalembert::passes
