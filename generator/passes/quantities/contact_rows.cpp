// A contact's rows: the velocity of its point along the world's axes, or the link's, then, of a weld, the angular velocity.
#include "passes/joints.hpp"
#include "passes/quantities/constraint_rows.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::Shape;

namespace {

class ContactRows : public ConstraintRows {
 public:
  ContactRows(const Builder& b, const ir::Contact& contact, const ir::Constraint& constraint, int index, int first)
      : ConstraintRows(constraint, index, first), contact_(contact), frame_(link_frame(contact.link, b.tree(), b.normal())) {
    frame_.name = name();
    frame_.translation += frame_.rotation * contact.at;
  }

  void columns(Builder& b, int array) const override;
  RowRoles velocities(Builder& b) const override;
  RowRoles biases(Builder& b) const override;
  RowRoles errors(Builder& b) const override;

 private:
  bool weld() const { return contact_.type == ir::ContactType::weld; }
  // What is along the link's axes does not depend on the first joints of a fixed base.
  Frame poses_frame() const { return contact_.along_link ? Frame::cheapest : Frame::base; }
  Shape shape() const { return weld() ? Shape::wrench : Shape::vector; }
  void store(SweepBuilder& s, int role, const Vec3& linear, const Vec3& angular, int coordinate = -1) const {
    s.store(role, linear, 0, coordinate);
    if (weld()) s.store(role, angular, 3, coordinate);
  }
  RowRoles roles(int role) const {
    RowRoles all;
    for (int i = 0; i < constraint().rows; ++i) all.emplace_back(role, i);
    return all;
  }

  ir::Contact contact_;
  LinkFrame frame_;

  friend class RowAxes;
};

// Twists at the point, turned to the rows' axes.
class RowAxes {
 public:
  RowAxes(Builder& b, const ContactRows& rows)
      : link_(rows.contact_.along_link),
        at_(link_place(b, rows.frame_, rows.poses_frame())),
        base_(link_ || !b.floating() ? LinkPlace{-1, -1} : base_in_world(b)) {}

  Vec3 point(SweepBuilder& s) const { return s.of3(-1, at_.origin); }
  Vec3 turned(SweepBuilder& s, const Vec3& x) const {
    if (link_) return transpose(three_columns(s, -1, at_.axes)) * x;
    return base_.axes < 0 ? x : three_columns(s, -1, base_.axes) * x;  // a fixed base's axes are the world's
  }

 private:
  bool link_;
  LinkPlace at_, base_;
};

void ContactRows::columns(Builder& b, int array) const {
  const Poses p = poses(b, poses_frame());
  const RowAxes axes(b, *this);
  const std::string equation = weld() ? "J = R [Jv + Jw x x; Jw]" : "J = R (Jv + Jw x x)";
  const int rows = b.role({"rows_" + name(), "Jc", "column of the rows of contact " + contact_.name, "m", shape()});
  SweepBuilder s = b.sweep("rows_" + name(), equation, Direction::anywhere);
  s.only_above(frame_.body);
  const auto add = [&](SweepBuilder& sweep, const Twist& twist, int coordinate) {
    const Vec3 lever = cross(twist.angular, axes.point(sweep)), velocity = twist.linear + lever;
    const Vec3 linear = axes.turned(sweep, velocity), angular = weld() ? axes.turned(sweep, twist.angular) : twist.angular;
    store(sweep, rows, linear, angular, coordinate);
  };
  add(s, joint_of(s, p), -1);
  if (b.floating()) {
    SweepBuilder base = b.sweep("base_rows_" + name(), equation, Direction::root);
    for (int j = 0; j < 6; ++j) add(base, unit_twist(base, j), j);
  }
  b.result({array, ir::Layout::columns, rows, first(), frame_.body});
}

RowRoles ContactRows::velocities(Builder& b) const {
  const Poses p = poses(b, poses_frame());
  const RowAxes axes(b, *this);
  const int role = b.role({"velocity_" + name(), "Jcv", "velocity of contact " + contact_.name, "m/s, rad/s", shape()});
  if (b.has("velocity_" + name())) return roles(role);
  SweepBuilder s = b.sweep("velocity_" + name(), weld() ? "J v = R [u + w x x; w]" : "J v = R (u + w x x)", Direction::root);
  const Vec3 u = s.of3(frame_.body, p.velocity, 0), w = s.of3(frame_.body, p.velocity, 3);
  const Vec3 lever = cross(w, axes.point(s)), velocity = u + lever;
  const Vec3 linear = axes.turned(s, velocity), angular = weld() ? axes.turned(s, w) : w;
  store(s, role, linear, angular);
  return roles(role);
}

// Along the link's axes: the spatial acceleration, for these turn with the link.
RowRoles ContactRows::biases(Builder& b) const {
  const Poses p = poses(b, poses_frame());
  const int of_bodies = bias_accelerations(b, poses_frame() == Frame::base);
  const RowAxes axes(b, *this);
  const int role = b.role({"bias_" + name(), "dJcv", "dJ/dt v of contact " + contact_.name, "m/s^2, rad/s^2", shape()});
  if (b.has("bias_" + name())) return roles(role);
  SweepBuilder s =
      b.sweep("bias_" + name(),
              contact_.along_link ? "dJ v = R [a + alpha x x; alpha]" : "dJ v = R [a + alpha x x + w x (u + w x x); alpha]",
              Direction::root);
  const int body = frame_.body;
  const Vec3 a = s.of3(body, of_bodies, 0), alpha = s.of3(body, of_bodies, 3), x = axes.point(s);
  const Vec3 tangential = cross(alpha, x);
  Vec3 linear = a + tangential;
  if (!contact_.along_link) {
    const Vec3 u = s.of3(body, p.velocity, 0), w = s.of3(body, p.velocity, 3);
    const Vec3 lever = cross(w, x), velocity = u + lever, centripetal = cross(w, velocity);
    linear = linear + centripetal;
  }
  const Vec3 turned = axes.turned(s, linear), angular = weld() ? axes.turned(s, alpha) : alpha;
  store(s, role, turned, angular);
  return roles(role);
}

// From its anchor, along the rows' axes: x − x₀, and ½ Σ aᵢ × rᵢ over the axes of anchor and link.
RowRoles ContactRows::errors(Builder& b) const {
  const LinkPlace at = link_place(b, frame_, Frame::base), base = base_in_world(b);
  const int role = b.role({"error_" + name(), "ec", "from its anchor to contact " + contact_.name, "m, rad", shape()});
  if (b.has("error_" + name())) return roles(role);
  SweepBuilder s = b.sweep("error_" + name(), "e = x - x0, and half the sum of a_i x r_i", Direction::root);
  const Mat3 to_world =
      b.floating() ? three_columns(s, -1, base.axes) : s.constant(Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
  const Mat3 in_base = three_columns(s, -1, at.axes), own = to_world * in_base;
  const Vec3 offset = to_world * s.of3(-1, at.origin), place = s.of3(-1, base.origin) + offset;
  const auto given = [&](int component) { return s.constraint(index(), component); };
  const Vec3 wanted{given(ir::contact_anchor), given(ir::contact_anchor + 1), given(ir::contact_anchor + 2)};
  Vec3 linear = place - wanted;
  Vec3 angular = s.zero();
  if (weld()) {
    const Mat3 anchor = base_rotation([&](int i) { return given(ir::contact_anchor + 3 + i); },
                                      [&](double value) { return s.constant(value); });
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 from = column(anchor, i), to = column(own, i), turning = cross(from, to);
      angular = angular + turning;
    }
    const Sym half = s.constant(0.5);
    angular = half * angular;
  }
  if (contact_.along_link) {
    linear = transpose(own) * linear;
    if (weld()) angular = transpose(own) * angular;
  }
  store(s, role, linear, angular);
  return roles(role);
}

}  // namespace

std::unique_ptr<ConstraintRows> contact_rows(const Builder& b, const ir::Contact& contact, const ir::Constraint& constraint,
                                             int index, int first) {
  return std::make_unique<ContactRows>(b, contact, constraint, index, first);
}

}  // namespace dalembert::passes
