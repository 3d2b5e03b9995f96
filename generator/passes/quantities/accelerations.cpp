#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::Shape;

int accelerations(Builder& b) {
  const Poses p = poses(b, Frame::base);
  const int a = b.role({"acceleration_twist", "A", "A = dV less gravity", "m/s^2, rad/s^2", Shape::wrench});
  if (b.has("accelerations")) return a;
  const bool solved = b.section().inputs == ir::Function::forward_dynamics;
  const SolvedRoles solution = solved ? solved_accelerations(b) : SolvedRoles{};
  SweepBuilder base = b.sweep_of_base("base_acceleration", "A = dv - gravity");
  const Twist dv = solved ? Twist{base.own3(solution.twist, 0), base.own3(solution.twist, 3)} : base.base_acceleration();
  base.store(a, Twist{dv.linear - base.gravity_in_base(), dv.angular});

  SweepBuilder s = b.sweep("accelerations", "A = Ap + J ddq + dJ dq", Direction::outwards);
  const Twist joint = joint_of(s, p), above{s.carried3(a, 0), s.carried3(a, 3)};
  const Twist moved = body_twist(above, joint, solved ? s.own(solution.acceleration) : s.acceleration());
  const Sym rate = s.rate();
  s.store(a, body_twist(moved, {s.own3(p.joint_rate, 0), s.own3(p.joint_rate, 3)}, rate));
  return a;
}

Twist acceleration_of(SweepBuilder& s, int role) { return {s.own3(role, 0), s.own3(role, 3)}; }

}  // namespace dalembert::passes
