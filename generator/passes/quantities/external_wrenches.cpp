// Wrenches that push links from outside: tau = M a + C v + g - the sum of J_l' F_l. Brought to the base's axes and origin, one
// is the same six numbers for every joint above its link. Where derivatives are those of what constraints hold, their forces
// push likewise: a loop's the second link, and back the first.
#include <algorithm>

#include "passes/quantities/constraint_rows.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::Shape;

namespace {

// Of one wrench, as roles of the base: about the base's origin, and its moment and the point about the link's own.
struct Push {
  int wrench, moment, origin;
  bool in_world;
};

std::string number(std::size_t wrench) { return std::to_string(wrench); }

Push wrench(Builder& b, std::size_t which) {
  const ir::ExternalWrench& external = b.scene().wrenches[which];
  const LinkFrame link = link_frame(external.link, b.tree(), b.normal());
  const LinkPlace at = link_place(b, link, Frame::base);
  const std::string name = "push_" + number(which), of = " on link " + external.link;
  const Push roles{b.role({name, "Fl", "f, n" + of + " about the base's origin", "N, N m", Shape::wrench}),
                   b.role({name + "_moment", "nl", "n" + of + " about the link's origin", "N m", Shape::vector}), at.origin,
                   external.in_world};
  if (b.has(name)) return roles;
  SweepBuilder s =
      b.sweep_of_base(name, external.in_world ? "f = X0' f_l, n = X0' n_l + x x f" : "f = X f_l, n = X n_l + x x f");
  const Mat3 turn = external.in_world ? transpose(s.base_axes()) : three_columns(s, -1, at.axes);
  const Twist given = s.external(static_cast<int>(which));
  const Vec3 force = turn * given.linear, moment = turn * given.angular, lever = cross(s.of3(-1, at.origin), force);
  s.store(roles.moment, moment);
  s.store(roles.wrench, Twist{force, moment + lever});
  return roles;
}

// The scene's, then those of its constraints.
std::size_t count_of(const Builder& b) {
  const std::size_t constraints = b.section().forces < 0 ? 0 : b.scene().constraints().size();
  return b.scene().wrenches.size() + constraints;
}

Push push(Builder& b, std::size_t which) {
  const std::size_t wrenches = b.scene().wrenches.size();
  if (which < wrenches) return wrench(b, which);
  const HeldRoles held = constraint_rows(b)[which - wrenches]->wrench(b);
  return {held.wrench, held.moment, held.point, held.in_world};
}

// On the robot as a whole: a loop's are none.
bool on_all(const Builder& b, std::size_t which) {
  const std::size_t wrenches = b.scene().wrenches.size();
  return which < wrenches || b.tree().held[which - wrenches].second == ir::nobody;
}

Sym bears(SweepBuilder& s, std::size_t which) { return s.parameter(bears_p + static_cast<int>(which)); }

// Y of a joint's twist; share: how much of a wrench counts.
template <class Share>
Twist derivative_of(Builder& b, SweepBuilder& s, const Twist& joint, const Share& share) {
  Twist sum{s.zero(), s.zero()};
  for (std::size_t i = 0; i < count_of(b); ++i) {
    const Push pushed = push(b, i);
    if (!pushed.in_world) continue;
    const Vec3 turned = cross(joint.angular, s.of3(-1, pushed.wrench, 0));
    const Vec3 lever = cross(s.of3(-1, pushed.origin), turned), moment = lever + cross(joint.angular, s.of3(-1, pushed.moment));
    sum.linear = sum.linear + share(i) * turned;
    sum.angular = sum.angular + share(i) * moment;
  }
  return sum;
}

}  // namespace

int external_wrenches(Builder& b) {
  const std::size_t count = count_of(b);
  if (count == 0) return -1;
  const int sum = b.role({"external", "E", "f, n of what pushes the subtree", "N, N m", Shape::wrench});
  if (b.has("external")) return sum;
  std::vector<int> each;
  for (std::size_t i = 0; i < count; ++i) each.push_back(push(b, i).wrench);
  const auto total = [&](SweepBuilder& s, bool of_base) {
    for (int c = 0; c < 6; ++c) {
      Sym all = s.constant(0);
      for (std::size_t i = 0; i < count; ++i) {
        if (of_base && !on_all(b, i)) continue;
        const Sym one = s.of(-1, each[i], c);
        all = all + (of_base ? one : bears(s, i) * one);
      }
      s.store(sum, c, all);
    }
  };
  SweepBuilder base = b.sweep_of_base("base_external", "E = the sum of all");
  total(base, true);
  SweepBuilder s = b.sweep("external", "E = the sum of those on the subtree", Direction::anywhere);
  total(s, false);
  return sum;
}

int less_external(Builder& b, int torque, int base_wrench) {
  const int external = external_wrenches(b);
  if (external < 0) return torque;
  const ir::Role of = b.role_of(torque);
  const std::string name = of.name + "_less_external";
  const int rest = b.role({name, of.symbol, of.meaning + " - E.J", of.unit, Shape::scalar});
  if (b.has(name)) return rest;
  const Poses p = poses(b, Frame::base);
  SweepBuilder s = b.sweep(name, of.meaning + " - E.J", Direction::anywhere);
  const Twist joint = joint_of(s, p);
  const Sym borne = element({s.own3(external, 0), s.own3(external, 3)}, joint);
  s.store(rest, s.own(torque) - borne);
  if (base_wrench >= 0 && b.base_coordinates() > 0) {
    SweepBuilder base = b.sweep_of_base("base_" + name, of.meaning + " - E");
    for (int j = 0; j < 6; ++j) {
      const Sym borne_by_base = base.own(external, j);
      base.store(rest, 0, base.own(base_wrench, j) - borne_by_base, j);
    }
  }
  return rest;
}

WorldWrenchRoles world_wrenches(Builder& b) {
  std::vector<Push> pushes;  // whose sweeps stand before this one
  for (std::size_t i = 0; i < count_of(b); ++i) pushes.push_back(push(b, i));
  if (std::none_of(pushes.begin(), pushes.end(), [](const Push& pushed) { return pushed.in_world; })) return {};
  const WorldWrenchRoles roles{
      b.role({"unturned", "X", "f x (u + w x x) + n x w, summed over wrenches along the world's axes", "N m", Shape::vector}),
      b.role({"turned_back", "Y", "[w x f; x x (w x f) + w x n], summed likewise", "N, N m", Shape::wrench})};
  if (b.has("world_wrenches")) return roles;
  const Poses p = poses(b, Frame::base);
  SweepBuilder s =
      b.sweep("world_wrenches", "X = f x (u + w x x) + n x w, Y = [w x f; x x (w x f) + w x n]", Direction::anywhere);
  const Twist joint = joint_of(s, p);
  s.store(roles.derivative, derivative_of(b, s, joint, [&](std::size_t i) { return bears(s, i); }));
  Vec3 lower = s.zero();
  for (std::size_t i = 0; i < pushes.size(); ++i) {
    const Push& pushed = pushes[i];
    if (!pushed.in_world) continue;
    const Vec3 f = s.of3(-1, pushed.wrench, 0), n = s.of3(-1, pushed.moment);
    const Vec3 velocity = joint.linear + cross(joint.angular, s.of3(-1, pushed.origin));
    const Vec3 turned = cross(n, joint.angular), own = cross(f, velocity) + turned;
    lower = lower + bears(s, i) * own;
  }
  s.store(roles.lower, lower);
  return roles;
}

Twist world_wrench_derivative(Builder& b, SweepBuilder& base, const Twist& unit) {
  return derivative_of(b, base, unit, [&](std::size_t) { return base.constant(1); });
}

}  // namespace dalembert::passes
