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
  int point_in_world(Builder& b) const override;
  void changes(Builder& b, bool by_q, int array) const override;
  HeldRoles wrench(Builder& b) const override;

 private:
  struct PointRoles {
    int kd, kp, rate, pull, spin, lever, turn;
  };
  PointRoles point_motion(Builder& b) const;

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
        base_(link_ || b.base_coordinates() == 0 ? LinkPlace{-1, -1} : base_in_world(b)) {}

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
  const auto add = [&](SweepBuilder& sweep, const Twist& twist, int coordinate) {
    const Vec3 lever = cross(twist.angular, axes.point(sweep)), velocity = twist.linear + lever;
    const Vec3 linear = axes.turned(sweep, velocity), angular = weld() ? axes.turned(sweep, twist.angular) : twist.angular;
    store(sweep, rows, linear, angular, coordinate);
  };
  const ir::BodySet moving = ir::BodySet::above(frame_.body);
  if (frame_.body >= 0) {
    SweepBuilder s = b.sweep("rows_" + name(), equation, Direction::anywhere, moving);
    add(s, joint_of(s, p), -1);
  }
  if (b.base_coordinates() > 0) {
    SweepBuilder base = b.sweep_of_base("base_rows_" + name(), equation);
    for (int j = 0; j < 6; ++j) add(base, unit_twist(base, j), j);
  }
  b.result({array, ir::Layout::columns, rows, first(), moving});
}

RowRoles ContactRows::velocities(Builder& b) const {
  const Poses p = poses(b, poses_frame());
  const RowAxes axes(b, *this);
  const int role = b.role({"velocity_" + name(), "Jcv", "velocity of contact " + contact_.name, "m/s, rad/s", shape()});
  if (b.has("velocity_" + name())) return roles(role);
  SweepBuilder s = b.sweep_of_base("velocity_" + name(), weld() ? "J v = R [u + w x x; w]" : "J v = R (u + w x x)");
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
  SweepBuilder s = b.sweep_of_base("bias_" + name(), contact_.along_link ? "dJ v = R [a + alpha x x; alpha]"
                                                                         : "dJ v = R [a + alpha x x + w x (u + w x x); alpha]");
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
  SweepBuilder s = b.sweep_of_base("error_" + name(), "e = x - x0, and half the sum of a_i x r_i");
  const Mat3 to_world =
      b.base_coordinates() > 0 ? three_columns(s, -1, base.axes) : s.constant(Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
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

int ContactRows::point_in_world(Builder& b) const {
  if (contact_.along_link) return -1;
  const RowAxes axes(b, *this);
  const std::string name_of_it = "point_in_world_" + name();
  const int role =
      b.role({name_of_it, "xw", "the point of contact " + contact_.name + " from the base's origin along the world's axes", "m",
              Shape::vector});
  if (b.has(name_of_it)) return role;
  SweepBuilder s = b.sweep_of_base(name_of_it, "x = X0 x");
  const Vec3 x = axes.turned(s, axes.point(s));
  s.store(role, x);
  return role;
}

HeldRoles ContactRows::wrench(Builder& b) const {
  const LinkPlace at = link_place(b, frame_, Frame::base);
  const std::string of = " of contact " + contact_.name;
  const HeldRoles roles{b.role({"hold_" + name(), "Fl", "f, n" + of + " about the base's origin", "N, N m", Shape::wrench}),
                        b.role({"moment_hold_" + name(), "nl", "n" + of + " about its point", "N m", Shape::vector}), at.origin,
                        !contact_.along_link};
  if (b.has("hold_" + name())) return roles;
  SweepBuilder s = b.sweep_of_base("hold_" + name(),
                                   contact_.along_link ? "f = X f_c, n = X n_c + x x f" : "f = X0' f_c, n = X0' n_c + x x f");
  const Mat3 turn = contact_.along_link ? three_columns(s, -1, at.axes) : transpose(s.base_axes());
  const auto given = [&](int from) {
    const auto one = [&](int i) { return s.element(b.section().forces, first() + from + i); };
    return Vec3{one(0), one(1), one(2)};
  };
  const Vec3 force = turn * given(0), moment = weld() ? turn * given(3) : s.zero(), lever = cross(s.of3(-1, at.origin), force);
  s.store(roles.moment, moment);
  s.store(roles.wrench, Twist{force, moment + lever});
  return roles;
}

// What the point's motion makes of a joint's, whichever it is. Along the world's axes: x' of the point, x'' + kd x', alpha + kd
// w. Along the link's: x', g + kp (x − x0), kp e. And E, which takes what turns the link to the rate of e: ½ Σ (aᵢ·rᵢ 1 − rᵢ
// aᵢᵀ).
ContactRows::PointRoles ContactRows::point_motion(Builder& b) const {
  const Poses p = poses(b, Frame::base);
  const AxisMotion motion = axis_motion(b);
  const LinkPlace at = link_place(b, frame_, Frame::base), base = base_in_world(b);
  const auto vector = [&](const char* what, const char* symbol, const char* meaning, const char* unit) {
    return b.role({what + name(), symbol, std::string(meaning) + " of contact " + contact_.name, unit, Shape::vector});
  };
  const PointRoles r{b.role({"kd_" + name(), "kd", "kd of contact " + contact_.name, "1/s", Shape::scalar}),
                     b.role({"kp_" + name(), "kp", "kp of contact " + contact_.name, "1/s^2", Shape::scalar}),
                     vector("point_rate_", "dx", "velocity of the point", "m/s"),
                     vector("point_pull_", "ddx", "what turning takes to its acceleration", "m/s^2"),
                     vector("point_spin_", "dw", "the same of the angular acceleration", "rad/s^2"),
                     vector("point_lever_", "xl", "the point", "m"),
                     b.role({"error_turn_" + name(), "E", "E of contact " + contact_.name, "", Shape::matrix})};
  if (b.has("point_" + name())) return r;
  SweepBuilder s = b.sweep_of_base("point_" + name(), contact_.along_link ? "dx = u + w x x; g + kp (x - x0), kp e, E"
                                                                          : "dx = u + w x x; ddx + kd dx, alpha + kd w, E");
  const Sym kd = s.constraint(index(), ir::contact_kd), kp = s.constraint(index(), ir::contact_kp);
  s.store(r.kd, kd);
  s.store(r.kp, kp);
  const int body = frame_.body;
  const Vec3 x = s.of3(-1, at.origin), u = s.of3(body, p.velocity, 0), w = s.of3(body, p.velocity, 3), lever = cross(w, x),
             rate = u + lever;
  s.store(r.lever, x);
  s.store(r.rate, rate);

  const Mat3 to_base = b.base_coordinates() > 0 ? transpose(three_columns(s, -1, base.axes))
                                                : s.constant(Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
  const auto given = [&](int component) { return s.constraint(index(), component); };
  const Mat3 own = three_columns(s, -1, at.axes);
  Mat3 anchor;
  if (weld()) {
    anchor = to_base * base_rotation([&](int i) { return given(ir::contact_anchor + 3 + i); },
                                     [&](double value) { return s.constant(value); });
    Sym trace = s.constant(0);
    Mat3 products;
    for (auto& row : products) row = s.zero();
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 from = column(anchor, i), to = column(own, i);
      trace = trace + dot(from, to);
      for (std::size_t j = 0; j < 3; ++j) products[j] = products[j] + to[j] * from;
    }
    const Sym half = s.constant(0.5);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        const Sym rest = i == j ? trace - products[i][j] : -products[i][j];
        s.store(r.turn, static_cast<int>(3 * i + j), half * rest);
      }
  }
  if (!contact_.along_link) {
    const Vec3 a = s.of3(body, motion.acceleration, 0), alpha = s.of3(body, motion.acceleration, 3);
    const Vec3 tangential = cross(alpha, x), centripetal = cross(w, rate), whole = a + tangential + centripetal;
    s.store(r.pull, whole + kd * rate);
    s.store(r.spin, alpha + kd * w);
    return r;
  }
  const Vec3 wanted{given(ir::contact_anchor), given(ir::contact_anchor + 1), given(ir::contact_anchor + 2)};
  const Vec3 less = to_base * (s.of3(-1, base.origin) - wanted), away = less + x;
  const Vec3 gravity = s.gravity_in_base();
  s.store(r.pull, gravity + kp * away);
  Vec3 error = s.zero();
  if (weld()) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 turning = cross(column(anchor, i), column(own, i));
      error = error + turning;
    }
    const Sym half = s.constant(0.5);
    error = kp * (half * error);
  }
  s.store(r.spin, error);
  return r;
}

void ContactRows::changes(Builder& b, bool by_q, int array) const {
  const Poses p = poses(b, Frame::base);
  const AxisMotion motion = axis_motion(b);
  const LinkPlace at = link_place(b, frame_, Frame::base), base_place = base_in_world(b);
  const PointRoles point = point_motion(b);
  const bool link = contact_.along_link;
  const std::string by = by_q ? "dq_" : "dv_";
  const std::string equation = by_q ? (link ? "R [Zx + psi x dx - w x psix - w_j x (g + kp d); ...], Z = Psi'' + kd Psi' + kp S"
                                            : "R [Zx + 2 psi x dx + w_j x (ddx + kd dx); ...], Z = Psi'' + kd Psi' + kp S")
                                    : (link ? "R [Zx - w x Sx + w_j x dx; ...], Z = Psi' + S' + kd S"
                                            : "R [Zx + 2 w_j x dx; ...], Z = Psi' + S' + kd S");
  const int role =
      b.role({"changes_" + by + name(), "da", "what the rows of contact " + contact_.name + " change by", "", shape()});
  const auto add = [&](SweepBuilder& s, const Twist& joint, const Twist& drift, const Twist& rates, const Twist& curvature,
                       int coordinate) {
    const auto base_role = [&](int own) { return s.of3(-1, own); };
    const Sym kd = s.of(-1, point.kd), kp = s.of(-1, point.kp);
    const Vec3 x = base_role(point.lever), dx = base_role(point.rate), w = s.of3(frame_.body, p.velocity, 3);
    const auto there = [&](const Twist& twist) {
      const Vec3 lever = cross(twist.angular, x);
      return twist.linear + lever;
    };
    Vec3 linear, angular;
    if (by_q) {
      const Vec3 damped = kd * drift.linear, drawn = kp * joint.linear, turning = kd * drift.angular,
                 turned = kp * joint.angular;
      const Twist all{curvature.linear + damped + drawn, curvature.angular + turning + turned};
      const Vec3 pull = cross(joint.angular, base_role(point.pull)), drifting = cross(drift.angular, dx);
      linear = there(all);
      if (link) {
        const Vec3 back = cross(w, there(drift));
        linear = linear + drifting - back - pull;
      } else {
        linear = linear + drifting + drifting + pull;
      }
      if (weld()) {
        const Mat3 turn{s.of3(-1, point.turn, 0), s.of3(-1, point.turn, 3), s.of3(-1, point.turn, 6)};
        const Vec3 spin = cross(joint.angular, base_role(point.spin)), towards = kp * (turn * joint.angular),
                   spun = cross(drift.angular, w);
        angular = curvature.angular + turning + towards + spun;
        angular = link ? angular - spin : angular + spin;
      }
    } else {
      const Vec3 damped = kd * joint.linear, turning = kd * joint.angular;
      const Twist all{rates.linear + damped, rates.angular + turning};
      const Vec3 turned = cross(joint.angular, dx);
      linear = there(all);
      if (link) {
        const Vec3 back = cross(w, there(joint));
        linear = linear + turned - back;
      } else {
        linear = linear + turned + turned;
      }
      if (weld()) {
        const Vec3 spin = cross(joint.angular, w);
        angular = all.angular + spin;
      }
    }
    const Mat3 axes = link                       ? transpose(three_columns(s, -1, at.axes))
                      : b.base_coordinates() > 0 ? three_columns(s, -1, base_place.axes)
                                                 : s.constant(Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
    const Vec3 turned_linear = axes * linear;
    store(s, role, turned_linear, weld() ? axes * angular : linear, coordinate);
  };
  const ir::BodySet moving = ir::BodySet::above(frame_.body);
  if (frame_.body >= 0) {
    SweepBuilder s = b.sweep("changes_" + by + name(), equation, Direction::anywhere, moving);
    const auto six = [&](int own) { return Twist{s.own3(own, 0), s.own3(own, 3)}; };
    const Twist curvature = six(motion.curvature), rates = six(motion.rates), drift = six(motion.drift);
    add(s, joint_of(s, p), drift, rates, curvature, -1);
  }
  if (b.base_coordinates() > 0) {
    SweepBuilder base = b.sweep_of_base("base_changes_" + by + name(), equation);
    const Twist none{base.zero(), base.zero()};
    for (int j = 0; j < 6; ++j) {
      const Twist unit = unit_twist(base, j);
      const BaseAxisMotion of = base_axis_motion(b, base, unit);
      add(base, unit, none, of.rates, of.curvature, j);
    }
  }
  b.result({array, ir::Layout::columns, role, first(), moving});
}

}  // namespace

std::unique_ptr<ConstraintRows> contact_rows(const Builder& b, const ir::Contact& contact, const ir::Constraint& constraint,
                                             int index, int first) {
  return std::make_unique<ContactRows>(b, contact, constraint, index, first);
}

}  // namespace dalembert::passes
