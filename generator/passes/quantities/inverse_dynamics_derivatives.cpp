// How inverse dynamics changes with q and v (Singh, Russell and Wensing 2022), along the tangent: where the base moves, column
// i is the change as the base moves along the i-th coordinate of its twist. With S the joint's twist (J elsewhere),
//
//   Psi' = Vp x S, Psi'' = Ap x S + Vp x Psi', S' = V x S (Psi' but for the base, whose Psi' is zero),
//
// and I, B, f the subtree's inertia, bias of Christoffel symbols and wrench: for j above i or i itself,
//
//   dtau_i/dq_j = S_i.(2 B_i Psi'_j + I_i Psi''_j)     dtau_j/dq_i = S_j.(2 B_i Psi'_i + I_i Psi''_i + S_i x* f_i)
//   dtau_i/dv_j = S_i.(2 B_i S_j + I_i (Psi'_j + S'_j))  dtau_j/dv_i = S_j.(2 B_i S_i + I_i (Psi'_i + S'_i)).
//
// Of a joint with a quaternion p is the same body for all parts, and S' of each is that of the link; among them f turns with
// S_j, too: dtau_j/dq_i has no S_i x* f_i, or f_i.(S_i x S_j) more than the above.
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::Shape;

namespace {

struct Factors {
  int between = -1;  // where joints have quaternions: the force along the joint, of the subtree
  int inertia, transposed, by_position, by_velocity;  // of the lower joint: I S, 2 Bᵀ S, and what stands in the sums above
  int joint_linear, joint_angular, rate, rates, curvature;  // of the upper one: S, Psi', Psi' + S', Psi''
  int unturned;  // of the lower one, where wrenches keep to the world's axes; -1: none does
};

Twist sum(const Twist& a, const Twist& b) { return {a.linear + b.linear, a.angular + b.angular}; }
Twist twice(const Twist& a) { return sum(a, a); }

// The wrench that the motion m turns f into: m x* f.
Twist turned(const Twist& m, const Twist& f) {
  const Vec3 lever = cross(m.linear, f.linear);
  return {cross(m.angular, f.linear), cross(m.angular, f.angular) + lever};
}

// Where joints have quaternions: how the body moves that a joint hangs on, for all its parts.
struct Hung {
  int velocity, acceleration;
};
Hung hung(Builder& b, const Poses& p, int acceleration) {
  const Hung r{b.role({"joint_base_velocity", "Vp", "V of what the joint hangs on", "m/s, rad/s", Shape::wrench}),
               b.role({"joint_base_acceleration", "Ap", "A of what the joint hangs on", "m/s^2, rad/s^2", Shape::wrench})};
  if (b.has("joint_bases")) return r;
  SweepBuilder root = b.sweep_of_base("base_of_joints", "Vp, Ap");
  for (const int role : {r.velocity, r.acceleration}) root.store(role, Twist{root.zero(), root.zero()});
  SweepBuilder s =
      b.sweep("joint_bases", "Vp, Ap: of the body above, or, behind a joint's first part, its", Direction::outwards);
  const Sym first = s.parameter(first_part_p), behind = s.constant(1) - first;
  for (int i = 0; i < 6; ++i) {
    const auto pick = [&](int own, int above) {
      const Sym begins = first * s.carried(above, i), goes_on = behind * s.carried(own, i);
      s.store(own, i, begins + goes_on);
    };
    pick(r.velocity, p.velocity);
    pick(r.acceleration, acceleration);
  }
  return r;
}

// f = I A + B V of a body, summed over the subtree.
int subtree_wrench(Builder& b, const Poses& p, const SumRoles& own, int acceleration) {
  const int body = b.role({"body_wrench", "fk", "f, n of the body", "N, N m", Shape::wrench});
  const int total = b.role({"wrench_below", "f", "f, n of the subtree", "N, N m", Shape::wrench, body});
  if (b.has("body_wrenches")) return total;
  SweepBuilder s = b.sweep("body_wrenches", "[f; n] = I A + B V of the body", Direction::anywhere);
  const Sums sums = sums_of(s, own);
  const Twist accelerated = acceleration_of(s, acceleration), inertial = apply_inertia(s.parameter(mass_p), sums, accelerated);
  s.store(body, sum(inertial, apply_bias(sums, velocity_of(s, p))));

  SweepBuilder a = b.sweep("accumulate_wrenches", "f, n summed over the subtree", Direction::inwards);
  for (int i = 0; i < 6; ++i) {
    const Sym below = a.carried(body, i), all = a.own(body, i) + below;
    a.store(total, i, all);
    a.hand_on(body, i, all);
  }
  return total;
}

// What pushes the robot from outside does so along the base's axes, and loops are looked at from one branch and the other.
Frame frame_of(const Builder& b) {
  const bool pushed = !b.scene().wrenches.empty() || !b.scene().constraints().empty();
  return b.chooses_reference() && !pushed && !b.tree().any_quaternion() ? Frame::cheapest : Frame::base;
}

Factors factors(Builder& b) {
  const Frame frame = frame_of(b);
  const Poses p = poses(b, frame);
  const int acceleration = accelerations(b, frame);
  const int mass = composite_mass(b);
  const BodyAndSubtree sums = christoffel_sums(b, frame);
  if (frame == Frame::cheapest) b.keep_moments_of_first();
  const int wrench = subtree_wrench(b, p, sums.body, acceleration);
  const int external = external_wrenches(b);
  const WorldWrenchRoles in_world = world_wrenches(b);
  const bool quaternions = b.tree().any_quaternion();
  const Factors r{quaternions ? b.role({"joint_force", "fJ", "f.S", "N, N m", Shape::scalar}) : -1,
                  forces(b, frame).inertia,
                  b.role({"twice_transposed", "H", "H = 2 B' S, its angular part", "kg m^2/s", Shape::vector}),
                  b.role({"by_position", "Nq", "2 B Psi' + I Psi'' + S x* f", "N, N m", Shape::wrench}),
                  b.role({"by_velocity", "Nv", "2 B S + I (Psi' + S')", "N s, N m s", Shape::wrench}),
                  p.joint_linear,
                  p.joint_angular,
                  b.role({"axis_rate", "Psi", "Psi', angular part", "rad/s", Shape::vector}),
                  b.role({"axis_rates", "Y", "Psi' + S'", "m/s, rad/s", Shape::wrench}),
                  b.role({"axis_curvature", "Psidd", "Psi''", "m/s^2, rad/s^2", Shape::wrench}),
                  in_world.lower};
  if (b.has("axes")) return r;

  const int axis_rates = quaternions ? b.role({"axis_drift", "Psid", "Psi'", "m/s, rad/s", Shape::wrench}) : p.joint_rate;
  const Hung parent = quaternions ? hung(b, p, acceleration) : Hung{p.velocity, acceleration};
  SweepBuilder axes =
      b.sweep("axes", quaternions ? "Psi' = Vp x S, Psi'' = Ap x S + Vp x Psi'" : "Psi' = V x S, Psi'' = A x S + V x Psi'",
              Direction::anywhere);
  const Twist joint = joint_of(axes, p), turned_with{axes.own3(p.joint_rate, 0), axes.own3(p.joint_rate, 3)};
  Twist rate = turned_with;
  if (quaternions) {
    rate = joint_twist_rate({axes.own3(parent.velocity, 0), axes.own3(parent.velocity, 3)}, joint);
    axes.store(axis_rates, rate);
  }
  const Twist turning = joint_twist_rate(acceleration_of(axes, parent.acceleration), joint);
  const Twist velocity{axes.own3(parent.velocity, 0), axes.own3(parent.velocity, 3)};
  axes.store(r.curvature, sum(turning, joint_twist_rate(velocity, rate)));
  axes.store(r.rate, rate.angular);
  axes.store(r.rates, sum(rate, turned_with));

  SweepBuilder s =
      b.sweep("derivative_factors", "H = 2 B' S, Nq = 2 B Psi' + I Psi'' + S x* f, Nv = 2 B S + 2 I Psi'", Direction::anywhere);
  const Sym m = s.own(mass);
  const Sums subtree = sums_of(s, sums.subtree);
  const Twist axis = joint_of(s, p), axis_rate{s.own3(axis_rates, 0), s.own3(axis_rates, 3)};
  Twist f{s.own3(wrench, 0), s.own3(wrench, 3)};
  if (external >= 0) f = {f.linear - s.own3(external, 0), f.angular - s.own3(external, 3)};
  const Vec3 transposed = apply_bias_transposed(subtree, axis);
  s.store(r.transposed, transposed + transposed);
  const Twist curved = apply_inertia(m, subtree, {s.own3(r.curvature, 0), s.own3(r.curvature, 3)});
  const Twist biased = twice(apply_bias(subtree, axis_rate));
  const Twist with_axis = turned(axis, f);
  Twist by_position = sum(sum(curved, biased), with_axis);
  if (in_world.derivative >= 0)
    by_position = sum(by_position, {s.own3(in_world.derivative, 0), s.own3(in_world.derivative, 3)});
  s.store(r.by_position, by_position);
  if (quaternions) {
    s.store(r.between, element(f, axis));
    const Twist moving = apply_inertia(m, subtree, {s.own3(r.rates, 0), s.own3(r.rates, 3)});
    s.store(r.by_velocity, sum(moving, twice(apply_bias(subtree, axis))));
  } else {
    const Twist moving = apply_inertia(m, subtree, axis_rate), drifting = apply_bias(subtree, axis);
    s.store(r.by_velocity, twice(sum(moving, drifting)));
  }
  if (b.base_coordinates() == 0) return r;

  // Its own wrench turns with the base: S x* f has no part in the base's rows of its own columns.
  SweepBuilder base = b.sweep_of_base("base_derivative_factors", "Psi' = 0, Psi'' = -gravity x S, S' = V x S");
  const Twist v = velocity_of(base, p);
  const Twist weight{-base.gravity_in_base(), base.zero()};
  const Sym base_mass = base.own(mass);
  const Sums all = sums_of(base, sums.subtree);
  for (int j = 0; j < b.base_coordinates(); ++j) {
    const Twist unit = unit_twist(base, j), drift = joint_twist_rate(v, unit), curvature = joint_twist_rate(weight, unit);
    base.store(r.rate, base.zero(), 0, j);
    base.store(r.rates, drift, j);
    base.store(r.curvature, curvature, j);
    const Twist weighed = apply_inertia(base_mass, all, curvature);
    base.store(r.by_position, in_world.derivative < 0 ? weighed : sum(weighed, world_wrench_derivative(b, base, unit)), j);
    const Twist moved = apply_inertia(base_mass, all, drift);
    base.store(r.by_velocity, sum(moved, twice(apply_bias(all, unit))), j);
  }
  return r;
}

}  // namespace

AxisMotion axis_motion(Builder& b) {
  const Factors f = factors(b);
  const int drift = b.tree().any_quaternion() ? b.role({"axis_drift", "Psid", "Psi'", "m/s, rad/s", Shape::wrench})
                                              : poses(b, frame_of(b)).joint_rate;
  return {drift, f.rates, f.curvature, accelerations(b, frame_of(b))};
}

BaseAxisMotion base_axis_motion(Builder& b, SweepBuilder& base, const Twist& unit) {
  const Twist weight{-base.gravity_in_base(), base.zero()};
  return {joint_twist_rate(velocity_of(base, poses(b, Frame::base)), unit), joint_twist_rate(weight, unit)};
}

void describe_inverse_dynamics_dq(Builder& b, int array) {
  const Factors f = factors(b);
  ir::Pairs p;
  p.array = array;
  p.equation = "dtau_i/dq_k = Nq_k.S_i, dtau_k/dq_i = F_k.Psi''_i + H_k.Psi'_i";
  p.above = {{f.by_position, 0, f.joint_linear, 0}, {f.by_position, 3, f.joint_angular, 0}};
  p.below = {{f.inertia, 0, f.curvature, 0}, {f.inertia, 3, f.curvature, 3}, {f.transposed, 0, f.rate, 0}};
  if (f.unturned >= 0) p.below.push_back({f.unturned, 0, f.joint_angular, 0});
  if (b.tree().any_spring()) p.diagonal = stiffness_p;
  p.between = f.between;
  b.pairs(p);
}

void describe_inverse_dynamics_dv(Builder& b, int array) {
  const Factors f = factors(b);
  ir::Pairs p;
  p.array = array;
  p.equation = "dtau_i/dv_k = Nv_k.S_i, dtau_k/dv_i = F_k.(Psi' + S')_i + H_k.S_i";
  p.above = {{f.by_velocity, 0, f.joint_linear, 0}, {f.by_velocity, 3, f.joint_angular, 0}};
  p.below = {{f.inertia, 0, f.rates, 0}, {f.inertia, 3, f.rates, 3}, {f.transposed, 0, f.joint_angular, 0}};
  p.diagonal = damping_p;
  b.pairs(p);
}

}  // namespace dalembert::passes
