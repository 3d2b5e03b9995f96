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

// How a body's link moves, about its origin and along its axes: what its unit parameters take is made of that.
struct LinkMotion {
  Vec3 acceleration, spin, turning;  // the first: of the origin, less gravity
};

LinkMotion link_motion(SweepBuilder& s, const NewtonEuler& motion) {
  const Mat3 to_link = transpose(s.parameter9(link_rotation_p));
  const Vec3 place = s.parameter3(link_translation_p), spin = s.own3(motion.angular),
             turning = s.own3(motion.angular_acceleration);
  const Vec3 centripetal = cross(spin, cross(spin, place)), tangential = cross(turning, place);
  const Vec3 a = to_link * (s.own3(motion.acceleration) + tangential + centripetal);
  const Vec3 w = to_link * spin;
  return {a, w, to_link * turning};
}

// Inputs of a projection's graph.
class Factors {
 public:
  explicit Factors(ir::Graph& graph) : graph_(&graph) {}
  Vec3 operator()(InputKind kind, int role, int from = 0) const {
    return {one(kind, role, from), one(kind, role, from + 1), one(kind, role, from + 2)};
  }
  Vec3 body(int role, int from = 0) const { return (*this)(InputKind::state, role, from); }
  Sym one(InputKind kind, int role, int component = 0) const { return {graph_, graph_->input({kind, role, component})}; }

 private:
  ir::Graph* graph_;
};

// The base's rows are the wrenches themselves: those of unit parameters along the axes and about the origin of the
// poses.
void project_wrenches(Builder& b, ir::Projection& y) {
  const NewtonEuler motion = newton_euler(b, Driven::accelerated);
  const LinkRoles links = link_frames(b);
  const Poses p = poses(b);
  const int mass = b.role({"unit_mass_wrench", "Wm", "wrench of a unit mass", "m/s^2, m^2/s^2", Shape::wrench});
  const int force = b.role({"unit_first_force", "Wh", "forces of unit m c, one after another", "1/s^2", Shape::matrix});
  const int moment = b.role({"unit_first_moment", "Wn", "their moments", "m/s^2", Shape::matrix});
  const int along_x = b.role({"unit_moments", "Kx", "moments of unit xx, xy, xz, one after another", "1/s^2", Shape::matrix});
  const int beyond_x =
      b.role({"more_unit_moments", "Ky", "moments of unit yy, yz, zz, one after another", "1/s^2", Shape::matrix});
  SweepBuilder s = b.sweep("unit_wrenches", "what unit m, m c and inertia of the link take", Direction::anywhere);
  const auto [a, w, turning] = link_motion(s, motion);
  const Vec3 z = s.own3(links.axes, 6), y_axis = s.own3(links.axes, 3), x = s.own3(links.axes, 0),
             origin = s.own3(links.origin);
  const Mat3 axes = from_columns(x, y_axis, z);
  const Vec3 weight = axes * a;
  s.store(mass, weight, 0);
  s.store(mass, cross(origin, weight), 3);
  const Sym xx = w[0] * w[0], yy = w[1] * w[1], zz = w[2] * w[2], xy = w[0] * w[1], xz = w[0] * w[2], yz = w[1] * w[2];
  const Vec3 spin[] = {Vec3{-(yy + zz), xy + turning[2], xz - turning[1]}, Vec3{xy - turning[2], -(xx + zz), yz + turning[0]},
                       Vec3{xz + turning[1], yz - turning[0], -(xx + yy)}};
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const Vec3 pushed = axes * spin[at], lever = cross(origin, pushed), unit = column(axes, at);
    s.store(force, pushed, 3 * i);
    s.store(moment, cross(unit, weight) + lever, 3 * i);
  }
  const Vec3 x_moments[] = {Vec3{turning[0], xz, -xy}, Vec3{turning[1] - xz, turning[0] + yz, xx - yy},
                            Vec3{turning[2] + xy, zz - xx, turning[0] - yz}};
  const Vec3 more_moments[] = {Vec3{-yz, turning[1], xy}, Vec3{yy - zz, turning[2] - xy, turning[1] + xz},
                               Vec3{yz, -xz, turning[2]}};
  for (int i = 0; i < 3; ++i) s.store(along_x, axes * x_moments[i], 3 * i);
  for (int i = 0; i < 3; ++i) s.store(beyond_x, axes * more_moments[i], 3 * i);

  y.equation = "Y_i = J_i times the wrenches of unit parameters";
  const Factors factor(y.graph);
  const Vec3 linear = factor(InputKind::carried, p.joint_linear), angular = factor(InputKind::carried, p.joint_angular);
  const auto column_of = [&](int forces, int moments, int from, int moment_from) {
    const Sym turned = dot(angular, factor.body(moments, moment_from));
    y.columns.push_back((forces < 0 ? turned : dot(linear, factor.body(forces, from)) + turned).id);
  };
  column_of(mass, mass, 0, 3);
  for (int i = 0; i < 3; ++i) column_of(force, moment, 3 * i, 3 * i);
  for (const int moments : {along_x, beyond_x})
    for (int i = 0; i < 3; ++i) column_of(-1, moments, 0, 3 * i);
}

// On a fixed base a body has few joints above it: their twists are moved to the link, where what unit parameters take is
// simple. With l and s a joint's twist there, t = s x w: the row of unit m is l.a, that of m c is l x dw + a x s + (l.w) w -
// w.w l, that of the inertia s.I dw + t.I w.
void project_twists(Builder& b, ir::Projection& y) {
  const NewtonEuler motion = newton_euler(b, Driven::accelerated);
  const LinkRoles links = link_frames(b);
  const int acceleration =
      b.role({"link_acceleration", "al", "acceleration of the link's origin less gravity", "m/s^2", Shape::vector});
  const int spin = b.role({"link_spin", "wl", "w along the link's axes", "rad/s", Shape::vector});
  const int turning = b.role({"link_turning", "dwl", "dw along the link's axes", "rad/s^2", Shape::vector});
  const int squared = b.role({"spin_squared", "ww", "w.w", "rad^2/s^2", Shape::scalar});
  SweepBuilder sweep = b.sweep("link_motion", "a, w and dw of the link along its axes", Direction::anywhere);
  const LinkMotion link = link_motion(sweep, motion);
  sweep.store(acceleration, link.acceleration);
  sweep.store(spin, link.spin);
  sweep.store(turning, link.turning);
  sweep.store(squared, dot(link.spin, link.spin));

  y.equation = "Y_i = the joint's twist in the link times what unit parameters take there";
  const Factors factor(y.graph);
  const auto [l, s] = joint_in_link(b, links, factor);
  const Vec3 a = factor.body(acceleration), w = factor.body(spin), dw = factor.body(turning);
  y.columns.push_back(dot(l, a).id);
  const Vec3 turned = cross(l, dw), moment = cross(a, s);
  const Sym along = dot(l, w), ww = factor.one(InputKind::state, squared);
  for (std::size_t i = 0; i < 3; ++i) {
    const Sym centripetal = difference_of_products(along, w[i], ww, l[i]);
    y.columns.push_back((turned[i] + moment[i] + centripetal).id);
  }
  const Vec3 t = cross(s, w);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = i; k < 3; ++k) {
      const Sym own = sum_of_products(s[i], dw[k], t[i], w[k]);
      y.columns.push_back((i == k ? own : sum_of_products(s[k], dw[i], t[k], w[i]) + own).id);
    }
}

}  // namespace

void describe_regressor(Builder& b, int array) {
  ir::Projection y;
  y.array = array;
  y.graph = b.new_graph();
  (b.base_coordinates() > 0 ? project_wrenches : project_twists)(b, y);
  b.projection(y);
}

}  // namespace dalembert::passes
