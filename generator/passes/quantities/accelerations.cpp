#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::Shape;

int accelerations(Builder& b, Frame frame) {
  const Poses p = poses(b, frame);
  const bool of_base = frame == Frame::base || !b.moves_reference();
  const std::string in = of_base ? "" : "reference_";
  const int a = b.role({in + "acceleration_twist", "A", "A = dV less gravity", "m/s^2, rad/s^2", Shape::wrench});
  if (b.has(in + "accelerations")) return a;
  const bool solved = b.section().inputs == ir::Function::forward_dynamics;
  const SolvedRoles solution = solved ? solved_accelerations(b) : SolvedRoles{};
  const int down = of_base ? -1 : gravity_in_reference(b);
  SweepBuilder base = b.sweep_of_base(in + "base_acceleration", of_base ? "A = dv - gravity" : "A = 0");
  const Twist dv = solved ? Twist{base.own3(solution.twist, 0), base.own3(solution.twist, 3)} : base.base_acceleration();
  base.store(a, of_base ? Twist{dv.linear - base.gravity_in_base(), dv.angular} : Twist{base.zero(), base.zero()});

  SweepBuilder s = b.sweep(in + "accelerations", "A = Ap + J ddq + dJ dq", Direction::outwards);
  const Twist joint = joint_of(s, p);
  Twist above{s.carried3(a, 0), s.carried3(a, 3)};
  if (!of_base) {
    const Vec3 weight = s.own3(down);
    above.linear = above.linear - s.parameter(on_base_p) * weight;
  }
  const Twist moved = body_twist(above, joint, solved ? s.own(solution.acceleration) : s.acceleration());
  const Sym rate = s.rate();
  s.store(a, body_twist(moved, {s.own3(p.joint_rate, 0), s.own3(p.joint_rate, 3)}, rate));
  return a;
}

Twist acceleration_of(SweepBuilder& s, int role) { return {s.own3(role, 0), s.own3(role, 3)}; }

}  // namespace dalembert::passes
