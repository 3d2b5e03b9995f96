// Y with Y phi = M a + C v + g, phi the ten inertial parameters of every body: m, m c, and the inertia about the origin of the
// body's link, all along the link's axes (Siciliano and Khatib 2016, section 6.2). Armature, damping, friction and springs are
// not in it.
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::InputKind;
using ir::Shape;

namespace {

// What unit parameters of a body take, about its link's origin and along its axes: the force of m is the acceleration, those of
// m c are the columns of `spin`, the moments of the inertia's xx xy xz and yy yz zz the columns of two matrices.
struct UnitWrenches {
  int acceleration, spin, along_x, beyond_x;
};

UnitWrenches unit_wrenches(Builder& b) {
  const NewtonEuler motion = newton_euler(b, Driven::accelerated);
  const UnitWrenches r{
      b.role({"link_acceleration", "al", "acceleration of the link's origin less gravity", "m/s^2", Shape::vector}),
      b.role({"link_spin", "Sl", "[alpha] + [w][w] along the link's axes, column by column", "1/s^2", Shape::matrix}),
      b.role({"unit_moments", "Kx", "moments of unit xx, xy, xz, one after another", "1/s^2", Shape::matrix}),
      b.role({"more_unit_moments", "Ky", "moments of unit yy, yz, zz, one after another", "1/s^2", Shape::matrix})};
  SweepBuilder s = b.sweep("unit_wrenches", "what unit m, m c and inertia of the link take", Direction::anywhere);
  const Mat3 to_link = transpose(s.parameter9(link_rotation_p));
  const Vec3 place = s.parameter3(link_translation_p), spin = s.own3(motion.angular),
             turning = s.own3(motion.angular_acceleration);
  const Vec3 centripetal = cross(spin, cross(spin, place)), tangential = cross(turning, place);
  s.store(r.acceleration, to_link * (s.own3(motion.acceleration) + tangential + centripetal));
  const Vec3 w = to_link * spin, a = to_link * turning;
  const Sym xx = w[0] * w[0], yy = w[1] * w[1], zz = w[2] * w[2], xy = w[0] * w[1], xz = w[0] * w[2], yz = w[1] * w[2];
  s.store(r.spin, Vec3{-(yy + zz), xy + a[2], xz - a[1]}, 0);
  s.store(r.spin, Vec3{xy - a[2], -(xx + zz), yz + a[0]}, 3);
  s.store(r.spin, Vec3{xz + a[1], yz - a[0], -(xx + yy)}, 6);
  s.store(r.along_x, Vec3{a[0], xz, -xy}, 0);
  s.store(r.along_x, Vec3{a[1] - xz, a[0] + yz, xx - yy}, 3);
  s.store(r.along_x, Vec3{a[2] + xy, zz - xx, a[0] - yz}, 6);
  s.store(r.beyond_x, Vec3{-yz, a[1], xy}, 0);
  s.store(r.beyond_x, Vec3{yy - zz, a[2] - xy, a[1] + xz}, 3);
  s.store(r.beyond_x, Vec3{yz, -xz, a[2]}, 6);
  return r;
}

}  // namespace

void describe_regressor(Builder& b, int array) {
  const LinkRoles links = link_frames(b);
  const UnitWrenches unit = unit_wrenches(b);
  ir::Projection y;
  y.array = array;
  y.equation = "Y_i = J_i of the link times the wrenches of its unit parameters";
  y.graph = b.new_graph();
  const auto three = [&](InputKind kind, int role, int from) {
    const auto input = [&](int i) { return Sym{&y.graph, y.graph.input({kind, role, from + i})}; };
    return Vec3{input(0), input(1), input(2)};
  };
  const Twist joint = joint_in_link(b, links, three);
  y.columns.push_back(dot(joint.linear, three(InputKind::state, unit.acceleration, 0)).id);
  const Vec3 a = three(InputKind::state, unit.acceleration, 0), lever = cross(a, joint.angular);
  for (int i = 0; i < 3; ++i)
    y.columns.push_back((dot(joint.linear, three(InputKind::state, unit.spin, 3 * i)) + lever[static_cast<std::size_t>(i)]).id);
  for (const int role : {unit.along_x, unit.beyond_x})
    for (int i = 0; i < 3; ++i) y.columns.push_back(dot(joint.angular, three(InputKind::state, role, 3 * i)).id);
  b.projection(y);
}

}  // namespace dalembert::passes
