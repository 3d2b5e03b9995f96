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
    SweepBuilder s =
        b.sweep("velocity_" + name(), is_distance() ? "J v = (xb - xa).(dxb - dxa)/l" : "J v = e'[du + dw x x; dw], b less a",
                Direction::root);
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
    SweepBuilder s = b.sweep("bias_" + name(),
                             is_distance() ? "dJ v = ((xb - xa).(ddxb - ddxa) + |dxb - dxa|^2)/l"
                                           : "dJ v = e'[da + dalpha x x + dw x dxb - wa x dr; dalpha - wa x dw]",
                             Direction::root);
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
    SweepBuilder s = b.sweep("error_" + name(),
                             is_distance()                      ? "e = (|xb - xa|^2 - l^2)/(2 l)"
                             : loop_.type == ir::LoopType::weld ? "e = xb - xa, and half the sum of a_i x b_i"
                             : loop_.angular_axes().empty()     ? "e = xb - xa"
                                                                : "e = xb - xa, and za x zb",
                             Direction::root);
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

 private:
  // The two frames, and twists of the two bodies.
  struct Motion {
    LinkPlace at[2];
    int bodies[2], velocity;

    Motion(Builder& b, const LoopRows& rows)
        : at{link_place(b, rows.frames_[0], rows.frame()), link_place(b, rows.frames_[1], rows.frame())},
          bodies{rows.frames_[0].body, rows.frames_[1].body},
          velocity(poses(b, rows.frame()).velocity) {}
    Vec3 point(SweepBuilder& s, int i) const { return s.of3(-1, at[i].origin); }
    Mat3 axes(SweepBuilder& s, int i) const { return three_columns(s, -1, at[i].axes); }
    Twist of(SweepBuilder& s, int role, int i) const { return {s.of3(bodies[i], role, 0), s.of3(bodies[i], role, 3)}; }
    Twist difference(SweepBuilder& s, int role) const {
      const Twist one = of(s, role, 0), other = of(s, role, 1);
      return {other.linear - one.linear, other.angular - one.angular};
    }
  };

  bool is_distance() const { return loop_.type == ir::LoopType::distance; }
  // Where two bodies are against each other is told by one frame for both: on a fixed base the cheapest frame of a body does without
  // the positions of the first joints above it, which may be others for either.
  Frame frame() const { return tree_.floating_base ? Frame::cheapest : Frame::base; }

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

  // The columns of the joints above one of the two bodies alone.
  void half(Builder& b, const std::string& sweep, std::size_t of, std::size_t beside, int array) const {
    int alone = 0;
    for (int k = frames_[of].body; k >= 0; k = tree_.bodies[static_cast<std::size_t>(k)].parent)
      alone += tree_.is_above(k, frames_[beside].body) ? 0 : 1;
    if (alone == 0) return;
    const Motion m(b, *this);
    const Poses p = poses(b, frame());
    const RowRoles roles = row_roles(b, of == 1 ? "column_" : "column_back_", "J", "column of the rows", "m", "");
    SweepBuilder s = b.sweep(sweep, is_distance() ? "J = (xb - xa).(Jv + Jw x xb)/l" : "J = e'[Jv + Jw x x; Jw], b less a",
                             Direction::anywhere);
    s.only_above(frames_[of].body, frames_[beside].body);
    const Twist joint = joint_of(s, p);
    const Vec3 lever = cross(joint.angular, m.point(s, 1)), linear = joint.linear + lever;
    if (of == 1) {
      store(s, m, roles, linear, joint.angular);
    } else {
      const Vec3 back = -linear, turning_back = -joint.angular;
      store(s, m, roles, back, turning_back);
    }
    for (std::size_t row = 0; row < roles.size(); ++row)
      b.result({array, ir::Layout::columns, roles[row].first, first() + static_cast<int>(row), frames_[of].body,
                frames_[beside].body});
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
