// A loop's rows: the motion of its second link, b, against the first, a, along the axes e of the frame on a, at the point x of
// b. With r = eᵀ (x_b − x_a), and w_a turning e, ṙ is the velocity of x_b against what of a is there, and
//
//   eᵀ ((u_b − u_a) + (w_b − w_a) × x)         eᵀ (Δa + Δα × x + Δw × ẋ_b − w_a × ṙ)
//   eᵀ (w_b − w_a)                             eᵀ (Δα − w_a × Δw)
//
// are the rows' velocities and what they change by. Of the joints above both bodies these know nothing: J is K (J_b − J_a), K
// the same for both. A distance has (|x_b − x_a|² − ℓ²) / 2ℓ in place of r: no root, and no direction that is lost at zero.
#include <algorithm>

#include "ir/loop_length.hpp"
#include "passes/quantities/constraint_rows.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::Shape;

namespace {

const char* const axis_names[] = {"x", "y", "z"};

// A vector and what it changes by.
struct Changing {
  Vec3 value, change;
};
Changing operator+(const Changing& a, const Changing& b) {
  const Vec3 value = a.value + b.value, change = a.change + b.change;
  return {value, change};
}
Changing operator-(const Changing& a, const Changing& b) {
  const Vec3 value = a.value - b.value, change = a.change - b.change;
  return {value, change};
}
Changing operator*(Sym factor, const Changing& a) {
  const Vec3 value = factor * a.value, change = factor * a.change;
  return {value, change};
}
Changing cross(const Changing& a, const Changing& b) {
  const Vec3 value = cross(a.value, b.value), one = cross(a.change, b.value), other = cross(a.value, b.change);
  return {value, one + other};
}
// Of a·b.
Sym change_of_dot(const Changing& a, const Changing& b) {
  const Sym one = dot(a.change, b.value), other = dot(a.value, b.change);
  return one + other;
}
struct ChangingTwist {
  Changing linear, angular;
};

class LoopRows : public ConstraintRows {
 public:
  LoopRows(const Builder& b, const ir::Loop& loop, const ir::Constraint& constraint, int index, int first)
      : ConstraintRows(constraint, index, first), loop_(loop), tree_(b.tree()) {
    for (std::size_t i = 0; i < 2; ++i) {
      frames_[i] = link_frame(loop.links[i], b.tree(), b.normal());
      frames_[i].name = name() + (i == 0 ? "_a" : "_b");
      frames_[i].translation += frames_[i].rotation * loop.at[i].translation();
      frames_[i].rotation = frames_[i].rotation * loop.at[i].linear();
    }
    if (is_distance()) length_ = ir::loop_length(b.tree(), loop);
  }

  void columns(Builder& b, int array) const override {
    half(b, "rows_" + name(), 1, 0, array);
    half(b, "rows_back_" + name(), 0, 1, array);
  }

  RowRoles velocities(Builder& b) const override {
    const Motion m(b, *this);
    const RowRoles roles = row_roles(b, "velocity_", "v", "velocity", "m/s", "rad/s");
    if (b.has("velocity_" + name())) return roles;
    SweepBuilder s = b.sweep_of_base("velocity_" + name(),
                                     is_distance() ? "J v = (xb - xa).(dxb - dxa)/l" : "J v = e'[du + dw x x; dw], b less a");
    const Twist d = m.difference(s, m.velocity);
    const Vec3 lever = cross(d.angular, m.point(s, 1)), linear = d.linear + lever;
    store(s, m, roles, linear, d.angular);
    return roles;
  }

  RowRoles biases(Builder& b) const override {
    const Motion m(b, *this);
    const int of_bodies = bias_accelerations(b, frame() == Frame::base);
    const RowRoles roles = row_roles(b, "bias_", "dv", "dJ/dt v", "m/s^2", "rad/s^2");
    if (b.has("bias_" + name())) return roles;
    SweepBuilder s =
        b.sweep_of_base("bias_" + name(), is_distance() ? "dJ v = ((xb - xa).(ddxb - ddxa) + |dxb - dxa|^2)/l"
                                                        : "dJ v = e'[da + dalpha x x + dw x dxb - wa x dr; dalpha - wa x dw]");
    const Vec3 x = m.point(s, 1);
    const Twist one = m.of(s, m.velocity, 0), other = m.of(s, m.velocity, 1);
    const Vec3 lever = cross(other.angular, x), speed = other.linear + lever;
    if (is_distance()) {
      const Vec3 x_one = m.point(s, 0), lever_one = cross(one.angular, x_one), speed_one = one.linear + lever_one;
      const Twist a = m.of(s, of_bodies, 0), c = m.of(s, of_bodies, 1);
      const auto whole = [&](const Twist& acceleration, const Vec3& at, const Vec3& w, const Vec3& rate) {
        const Vec3 tangential = cross(acceleration.angular, at), centripetal = cross(w, rate);
        return acceleration.linear + tangential + centripetal;
      };
      const Vec3 of_one = whole(a, x_one, one.angular, speed_one), of_other = whole(c, x, other.angular, speed);
      const Vec3 between = x - x_one, against = speed - speed_one;
      const Sym along = dot(between, of_other - of_one), squared = dot(against, against), inverse = s.constant(1 / length_);
      s.store(roles[0].first, 0, inverse * (along + squared));
      return roles;
    }
    const Twist d = m.difference(s, m.velocity), a = m.difference(s, of_bodies);
    const Vec3 turning = cross(d.angular, x), against = d.linear + turning;
    const Vec3 tangential = cross(a.angular, x), centripetal = cross(d.angular, speed), carried = cross(one.angular, against);
    const Vec3 linear = a.linear + tangential + centripetal - carried, drift = cross(one.angular, d.angular);
    store(s, m, roles, linear, a.angular - drift);
    return roles;
  }

  // From a's frame to b's along a's axes: x_b − x_a; of a weld ½ Σ aᵢ × bᵢ, else z_a × z_b.
  RowRoles errors(Builder& b) const override {
    const Motion m(b, *this);
    const RowRoles roles = row_roles(b, "error_", "e", "error", "m", "rad");
    if (b.has("error_" + name())) return roles;
    SweepBuilder s =
        b.sweep_of_base("error_" + name(), is_distance()                      ? "e = (|xb - xa|^2 - l^2)/(2 l)"
                                           : loop_.type == ir::LoopType::weld ? "e = xb - xa, and half the sum of a_i x b_i"
                                           : loop_.angular_axes().empty()     ? "e = xb - xa"
                                                                              : "e = xb - xa, and za x zb");
    const Vec3 from = m.point(s, 0), between = m.point(s, 1) - from;
    if (is_distance()) {
      const Sym squared = dot(between, between), wanted = s.constant(length_ * length_), scale = s.constant(0.5 / length_);
      s.store(roles[0].first, 0, scale * (squared - wanted));
      return roles;
    }
    Vec3 angular = s.zero();
    if (!loop_.angular_axes().empty()) {
      const Mat3 own = m.axes(s, 0), other = m.axes(s, 1);
      if (loop_.type == ir::LoopType::weld) {
        for (std::size_t i = 0; i < 3; ++i) {
          const Vec3 from = column(own, i), to = column(other, i), turning = cross(from, to);
          angular = angular + turning;
        }
        const Sym half = s.constant(0.5);
        angular = half * angular;
      } else {
        const Vec3 from = column(own, 2), to = column(other, 2);
        angular = cross(from, to);
      }
    }
    store(s, m, roles, between, angular);
    return roles;
  }

  void changes(Builder& b, bool by_q, int array) const override {
    half_of_changes(b, by_q, 1, 0, array);
    half_of_changes(b, by_q, 0, 1, array);
  }

  HeldRoles wrench(Builder& b) const override {
    const Motion m(b, *this, Frame::base);
    const HeldRoles roles{
        b.role({"hold_" + name(), "Fl", "f, n of loop " + loop_.name + " on its second link about the base's origin", "N, N m",
                Shape::wrench}),
        b.role({"moment_hold_" + name(), "nl", "n of loop " + loop_.name + " about its point", "N m", Shape::vector}),
        m.at[1].origin, false};
    if (b.has("hold_" + name())) return roles;
    SweepBuilder s =
        b.sweep_of_base("hold_" + name(), is_distance() ? "f = f_c (xb - xa)/l, n = x x f" : "f = e f_c, n = e n_c + x x f");
    const Vec3 x = m.point(s, 1);
    int row = first();
    const auto given = [&] { return s.element(b.section().forces, row++); };
    Vec3 force = s.zero(), moment = s.zero();
    if (is_distance()) {
      const Sym inverse = s.constant(1 / length_), scale = given() * inverse;
      s.store(tension(b), scale);
      const Vec3 from = m.point(s, 0), between = x - from;
      force = scale * between;
    } else {
      const Mat3 axes = m.axes(s, 0);
      for (const int i : loop_.linear_axes()) {
        const Vec3 along = given() * column(axes, static_cast<std::size_t>(i));
        force = force + along;
      }
      for (const int i : loop_.angular_axes()) {
        const Vec3 along = given() * column(axes, static_cast<std::size_t>(i));
        moment = moment + along;
      }
    }
    const Vec3 lever = cross(x, force);
    s.store(roles.moment, moment);
    s.store(roles.wrench, Twist{force, moment + lever});
    return roles;
  }

  // f turns with a, and acts at b's point. For columns i of any joint and j of one above b alone, S at the point,
  //
  //   i above b: s_i.(w_j x f) + w_i.(w_j x n)     i above a: w_i.(s_j x f),
  //
  // both of them where i is above both; and less that for j above a alone. Of a distance, f along d = x_b − x_a, and κ = f / ℓ:
  //
  //   i above b: s_i.(w_j x f − κ s_j)     i above a, S_i at its point: s_i.κ s_j
  //
  // for j above b; likewise for j above a, S_j at its point: s_i.κ s_j and −s_i.(w_j x f + κ s_j).
  void turning(Builder& b, int left, int right, int row) const override {
    for (const std::size_t of : {1u, 0u}) {
      turns(b, of, left, row);
      turned(b, of, 1 - of, right, row);
    }
  }

 private:
  // The two frames, and twists of the two bodies.
  struct Motion {
    LinkPlace at[2];
    int bodies[2], velocity;

    Motion(Builder& b, const LoopRows& rows) : Motion(b, rows, rows.frame()) {}
    Motion(Builder& b, const LoopRows& rows, Frame frame)
        : at{link_place(b, rows.frames_[0], frame), link_place(b, rows.frames_[1], frame)},
          bodies{rows.frames_[0].body, rows.frames_[1].body},
          velocity(poses(b, frame).velocity) {}
    Vec3 point(SweepBuilder& s, int i) const { return s.of3(-1, at[i].origin); }
    Mat3 axes(SweepBuilder& s, int i) const { return three_columns(s, -1, at[i].axes); }
    Twist of(SweepBuilder& s, int role, int i) const { return {s.of3(bodies[i], role, 0), s.of3(bodies[i], role, 3)}; }
    Twist difference(SweepBuilder& s, int role) const {
      const Twist one = of(s, role, 0), other = of(s, role, 1);
      return {other.linear - one.linear, other.angular - one.angular};
    }
  };

  bool is_distance() const { return loop_.type == ir::LoopType::distance; }
  // Where two bodies are against each other is told by one frame for both: on a fixed base the cheapest frame of a body does
  // without the positions of the first joints above it, which may be others for either.
  Frame frame() const { return tree_.base_coordinates() > 0 ? Frame::cheapest : Frame::base; }

  RowRoles row_roles(Builder& b, const std::string& begin, const std::string& symbol, const std::string& what,
                     const std::string& linear, const std::string& angular) const {
    RowRoles roles;
    const auto add = [&](const std::string& row, const std::string& words, const std::string& unit) {
      roles.emplace_back(
          b.role({begin + row + "_" + name(), symbol + row, what + " of loop " + loop_.name + words, unit, Shape::scalar}), 0);
    };
    if (is_distance()) {
      add("l", "", linear);
      return roles;
    }
    for (const int i : loop_.linear_axes()) add(axis_names[i], std::string(" along ") + axis_names[i], linear);
    for (const int i : loop_.angular_axes())
      add(std::string("r") + axis_names[i], std::string(" about ") + axis_names[i], angular);
    return roles;
  }

  // Rows of a motion of b against a, given along the base's axes at x.
  void store(SweepBuilder& s, const Motion& m, const RowRoles& roles, const Vec3& linear, const Vec3& angular) const {
    if (is_distance()) {
      const Vec3 from = m.point(s, 0), between = m.point(s, 1) - from;
      const Sym along = dot(between, linear);
      s.store(roles[0].first, 0, s.constant(1 / length_) * along);
      return;
    }
    const Mat3 axes = m.axes(s, 0);
    std::size_t row = 0;
    for (const int i : loop_.linear_axes())
      s.store(roles[row++].first, 0, dot(column(axes, static_cast<std::size_t>(i)), linear));
    for (const int i : loop_.angular_axes())
      s.store(roles[row++].first, 0, dot(column(axes, static_cast<std::size_t>(i)), angular));
  }

  // What is above one of the two bodies alone.
  ir::BodySet alone(std::size_t of, std::size_t beside) const {
    return ir::BodySet::above(frames_[of].body, frames_[beside].body);
  }
  // Whether there are joints there.
  bool any_alone(std::size_t of, std::size_t beside) const {
    for (int k = frames_[of].body; k >= 0; k = tree_.bodies[static_cast<std::size_t>(k)].parent)
      if (alone(of, beside).contains(tree_, k)) return true;
    return false;
  }

  // Their columns.
  void half(Builder& b, const std::string& sweep, std::size_t of, std::size_t beside, int array) const {
    if (!any_alone(of, beside)) return;
    const Motion m(b, *this);
    const Poses p = poses(b, frame());
    const RowRoles roles = row_roles(b, of == 1 ? "column_" : "column_back_", "J", "column of the rows", "m", "");
    SweepBuilder s = b.sweep(sweep, is_distance() ? "J = (xb - xa).(Jv + Jw x xb)/l" : "J = e'[Jv + Jw x x; Jw], b less a",
                             Direction::anywhere, alone(of, beside));
    const Twist joint = joint_of(s, p);
    const Vec3 lever = cross(joint.angular, m.point(s, 1)), linear = joint.linear + lever;
    if (of == 1) {
      store(s, m, roles, linear, joint.angular);
    } else {
      const Vec3 back = -linear, turning_back = -joint.angular;
      store(s, m, roles, back, turning_back);
    }
    for (std::size_t row = 0; row < roles.size(); ++row)
      b.result({array, ir::Layout::columns, roles[row].first, first() + static_cast<int>(row), alone(of, beside)});
  }

  void half_of_changes(Builder& b, bool by_q, std::size_t of, std::size_t beside, int array) const {
    if (!any_alone(of, beside)) return;
    const Poses p = poses(b, Frame::base);
    const AxisMotion motion = axis_motion(b);
    const Motion m(b, *this, Frame::base);
    const RowRoles gains = gain_roles(b);
    const std::string by = std::string(by_q ? "dq_" : "dv_") + (of == 1 ? "" : "back_");
    const RowRoles roles = row_roles(b, "changes_" + by, "da", "what its rows change by", "", "");
    SweepBuilder s = b.sweep("changes_" + by + name(), "what J dv + dJ v + kd J v + kp e changes by, dv held",
                             Direction::anywhere, alone(of, beside));
    const Sym kd = s.of(-1, gains[0].first), kp = s.of(-1, gains[1].first);
    const auto six = [&](int role) { return Twist{s.own3(role, 0), s.own3(role, 3)}; };
    const Twist joint = joint_of(s, p), drift = six(motion.drift), rates = six(motion.rates), curvature = six(motion.curvature);

    // Of the body that moves, and the other.
    const auto less = [](const Twist& a, const Twist& c) {
      const Vec3 linear = a.linear - c.linear, angular = a.angular - c.angular;
      return Twist{linear, angular};
    };
    const auto changing = [&](std::size_t i, int role, const Twist& change) {
      const Twist value = m.of(s, role, static_cast<int>(i));
      return i == of ? ChangingTwist{{value.linear, change.linear}, {value.angular, change.angular}}
                     : ChangingTwist{{value.linear, s.zero()}, {value.angular, s.zero()}};
    };
    const Twist v = m.of(s, m.velocity, static_cast<int>(of)), a = m.of(s, motion.acceleration, static_cast<int>(of));
    Twist of_v = joint, of_a;
    const Twist turned = joint_twist_rate(v, joint);
    if (by_q) {
      of_v = less(drift, turned);
      const Twist carried = joint_twist_rate(a, joint), drifting = joint_twist_rate(v, drift);
      of_a = less(less(curvature, carried), drifting);
    } else {
      of_a = less(rates, turned);
    }
    ChangingTwist V[2], A[2];
    Changing x[2], axes[2][3];
    for (std::size_t i = 0; i < 2; ++i) {
      V[i] = changing(i, m.velocity, of_v);
      A[i] = changing(i, motion.acceleration, of_a);
      const bool moves = by_q && i == of;
      const Vec3 point = m.point(s, static_cast<int>(i)), lever = cross(joint.angular, point);
      x[i] = {point, moves ? joint.linear + lever : s.zero()};
      const Mat3 own = m.axes(s, static_cast<int>(i));
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 axis = column(own, k);
        axes[i][k] = {axis, moves ? passes::cross(joint.angular, axis) : s.zero()};
      }
    }
    const auto velocity_at = [&](std::size_t i, const Changing& point) {
      const Changing lever = cross(V[i].angular, point);
      return V[i].linear + lever;
    };
    const Changing rate = velocity_at(1, x[1]), between = x[1] - x[0];
    if (is_distance()) {
      const auto acceleration_at = [&](std::size_t i, const Changing& speed) {
        const Changing tangential = cross(A[i].angular, x[i]), centripetal = cross(V[i].angular, speed);
        return A[i].linear + tangential + centripetal;
      };
      const Changing rate_from = velocity_at(0, x[0]), against = rate - rate_from;
      const Changing of_other = acceleration_at(1, rate), of_one = acceleration_at(0, rate_from), pulled = of_other - of_one;
      const Changing damped = kd * against, all = pulled + damped;
      const Sym half = s.constant(0.5), spring = half * kp;
      const Sym along = change_of_dot(between, all), squared = change_of_dot(against, against),
                drawn = spring * change_of_dot(between, between);
      const Sym inverse = s.constant(1 / length_), all_of_it = along + squared + drawn;
      s.store(roles[0].first, 0, inverse * all_of_it);
      b.result({array, ir::Layout::columns, roles[0].first, first(), alone(of, beside)});
      return;
    }
    const ChangingTwist d{V[1].linear - V[0].linear, V[1].angular - V[0].angular},
        dA{A[1].linear - A[0].linear, A[1].angular - A[0].angular};
    const Changing turning = cross(d.angular, x[1]), against = d.linear + turning;
    const Changing tangential = cross(dA.angular, x[1]), centripetal = cross(d.angular, rate),
                   carried = cross(V[0].angular, against), spun = cross(V[0].angular, d.angular);
    const Changing damped = kd * against, drawn = kp * between;
    const Changing linear = dA.linear + tangential + centripetal - carried + damped + drawn;
    Changing angular{s.zero(), s.zero()};
    if (!loop_.angular_axes().empty()) {
      Changing error{s.zero(), s.zero()};
      if (loop_.type == ir::LoopType::weld) {
        for (std::size_t k = 0; k < 3; ++k) error = error + cross(axes[0][k], axes[1][k]);
        const Sym half = s.constant(0.5);
        error = half * error;
      } else {
        error = cross(axes[0][2], axes[1][2]);
      }
      const Changing slowed = kd * d.angular, towards = kp * error;
      angular = dA.angular - spun + slowed + towards;
    }
    std::size_t row = 0;
    for (const int i : loop_.linear_axes())
      s.store(roles[row++].first, 0, change_of_dot(axes[0][static_cast<std::size_t>(i)], linear));
    for (const int i : loop_.angular_axes())
      s.store(roles[row++].first, 0, change_of_dot(axes[0][static_cast<std::size_t>(i)], angular));
    for (row = 0; row < roles.size(); ++row)
      b.result({array, ir::Layout::columns, roles[row].first, first() + static_cast<int>(row), alone(of, beside)});
  }

  // Of a distance: f / ℓ.
  int tension(Builder& b) const {
    return b.role({"tension_" + name(), "k", "force of loop " + loop_.name + " by its length", "N/m", Shape::scalar});
  }

  // kd and kp.
  RowRoles gain_roles(Builder& b) const {
    const RowRoles roles{{b.role({"kd_" + name(), "kd", "kd of loop " + loop_.name, "1/s", Shape::scalar}), 0},
                         {b.role({"kp_" + name(), "kp", "kp of loop " + loop_.name, "1/s^2", Shape::scalar}), 0}};
    if (b.has("gains_" + name())) return roles;
    SweepBuilder s = b.sweep_of_base("gains_" + name(), "kd, kp");
    s.store(roles[0].first, s.constraint(index(), ir::contact_kd));
    s.store(roles[1].first, s.constraint(index(), ir::contact_kp));
    return roles;
  }

  // The left factor: of all that moves one of the bodies.
  void turns(Builder& b, std::size_t of, int array, int row) const {
    const bool second = of == 1;
    const Poses p = poses(b, Frame::base);
    const Motion m(b, *this, Frame::base);
    const std::string name = (second ? "turns_" : "turns_back_") + this->name();
    const auto vector = [&](const char* number, const char* symbol) {
      return b.role({name + number, symbol, "what forces of loop " + loop_.name + " that turn are felt by", "", Shape::vector});
    };
    // Of the point, and of the angular velocity.
    const bool slides = second || is_distance(), turns = !is_distance();
    const int linear = vector("_linear", "tv"), angular = vector("_angular", "tw");
    const auto add = [&](SweepBuilder& s, const Twist& joint, int coordinate) {
      if (slides) {
        const Vec3 lever = cross(joint.angular, m.point(s, static_cast<int>(of)));
        s.store(linear, joint.linear + lever, 0, coordinate);
      }
      if (turns) s.store(angular, joint.angular, 0, coordinate);
    };
    const int body = frames_[of].body;
    if (body >= 0) {
      SweepBuilder s = b.sweep(name, "S at the point", Direction::anywhere, ir::BodySet::above(body));
      add(s, joint_of(s, p), -1);
    }
    if (b.base_coordinates() > 0) {
      SweepBuilder base = b.sweep_of_base("base_" + name, "S at the point");
      for (int j = 0; j < 6; ++j) add(base, unit_twist(base, j), j);
    }
    if (slides)
      b.result({array, ir::Layout::columns, linear, row + (is_distance() && !second ? 3 : 0), ir::BodySet::above(body)});
    if (turns) b.result({array, ir::Layout::columns, angular, row + (second ? 3 : 6), ir::BodySet::above(body)});
  }

  // The right one: of what moves one alone.
  void turned(Builder& b, std::size_t of, std::size_t beside, int array, int row) const {
    if (!any_alone(of, beside)) return;
    const bool second = of == 1;
    const Poses p = poses(b, Frame::base);
    const Motion m(b, *this, Frame::base);
    const HeldRoles held = wrench(b);
    const std::string name = (second ? "turned_" : "turned_back_") + this->name();
    int roles[3];
    for (int i = 0; i < 3; ++i)
      roles[i] = b.role({name + "_" + std::to_string(i), "tf" + std::to_string(i),
                         "what forces of loop " + loop_.name + " turn by", "", Shape::vector});
    SweepBuilder s =
        b.sweep(name, is_distance() ? "k s, w x f" : "w x f, w x n, s x f", Direction::anywhere, alone(of, beside));
    const Twist joint = joint_of(s, p);
    const Vec3 x = m.point(s, is_distance() ? static_cast<int>(of) : 1), lever = cross(joint.angular, x),
               speed = joint.linear + lever, f = s.of3(-1, held.wrench, 0), turned = cross(joint.angular, f);
    Vec3 three[3];
    int count = 3;
    if (is_distance()) {
      const Vec3 drawn = s.of(-1, tension(b)) * speed;
      three[0] = second ? turned - drawn : drawn;
      three[1] = second ? drawn : -(turned + drawn);
      count = 2;
    } else {
      const Vec3 spun = cross(joint.angular, s.of3(-1, held.moment)), moved = cross(speed, f);
      three[0] = second ? turned : -turned;
      three[1] = second ? spun : -spun;
      three[2] = second ? moved : -moved;
    }
    for (int i = 0; i < count; ++i) {
      s.store(roles[i], three[i]);
      b.result({array, ir::Layout::columns, roles[i], row + 3 * i, alone(of, beside)});
    }
  }

  ir::Loop loop_;
  const ir::KinematicTree& tree_;
  LinkFrame frames_[2];
  double length_ = 0;
};

}  // namespace

std::unique_ptr<ConstraintRows> loop_rows(const Builder& b, const ir::Loop& loop, const ir::Constraint& constraint, int index,
                                          int first) {
  return std::make_unique<LoopRows>(b, loop, constraint, index, first);
}

std::vector<std::unique_ptr<ConstraintRows>> constraint_rows(const Builder& b) {
  std::vector<std::unique_ptr<ConstraintRows>> all;
  const std::vector<ir::Constraint> constraints = b.scene().constraints();
  const std::size_t contacts = b.scene().contacts.size();
  int row = 0;
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const int index = static_cast<int>(i);
    if (i < contacts) all.push_back(contact_rows(b, b.scene().contacts[i], constraints[i], index, row));
    else all.push_back(loop_rows(b, b.scene().loops[i - contacts], constraints[i], index, row));
    row += constraints[i].rows;
  }
  return all;
}

}  // namespace dalembert::passes
