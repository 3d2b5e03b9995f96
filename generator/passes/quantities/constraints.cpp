// Rows of contacts, J v̇ + J̇ v = b, and what keeps to them. Everything is along the base's axes and about its origin: the point
// x of a body of twist [u; w] and acceleration [a; α] has the velocity u + w × x and the acceleration a + α × x + w × (u + w ×
// x); rows are these turned to the axes asked for.
#include "dalembert/constraint_shapes.hpp"
#include "ir/constraint_step.hpp"
#include "ir/identifier.hpp"
#include "passes/joints.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::Shape;

namespace {

// A contact's point as a frame, and the axes of its rows.
struct Held {
  const ir::Contact* contact;
  int index, first;  // among the contacts; its first row
  LinkFrame frame;
  std::string name;

  bool weld() const { return contact->type == ir::ContactType::weld; }
  // What is along the link's axes does not depend on the first joints of a fixed base.
  Frame poses() const { return contact->along_link ? Frame::cheapest : Frame::base; }
  Shape shape() const { return weld() ? Shape::wrench : Shape::vector; }
};

std::vector<Held> held_links(const Builder& b) {
  std::vector<Held> all;
  int row = 0;
  for (const ir::Contact& contact : b.scene().contacts) {
    Held held{&contact, static_cast<int>(all.size()), row, link_frame(contact.link, b.tree(), b.normal()), ""};
    held.name = held.frame.name = "contact_" + ir::identifier(contact.name);
    held.frame.translation += held.frame.rotation * contact.at;
    all.push_back(held);
    row += contact.rows();
  }
  return all;
}

// Twists at the point, turned to the rows' axes.
class RowAxes {
 public:
  RowAxes(Builder& b, const Held& held)
      : link_(held.contact->along_link),
        at_(link_place(b, held.frame, held.poses())),
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

void store_rows(SweepBuilder& s, const Held& held, int role, const Vec3& linear, const Vec3& angular, int coordinate = -1) {
  s.store(role, linear, 0, coordinate);
  if (held.weld()) s.store(role, angular, 3, coordinate);
}

void describe_rows(Builder& b, const Held& held, int array) {
  const Poses p = poses(b, held.poses());
  const RowAxes axes(b, held);
  const std::string equation = held.weld() ? "J = R [Jv + Jw x x; Jw]" : "J = R (Jv + Jw x x)";
  const int rows =
      b.role({"rows_" + held.name, "Jc", "column of the rows of contact " + held.contact->name, "m", held.shape()});
  SweepBuilder s = b.sweep("rows_" + held.name, equation, Direction::anywhere);
  s.only_above(held.frame.body);
  const auto store = [&](SweepBuilder& sweep, const Twist& twist, int coordinate) {
    const Vec3 lever = cross(twist.angular, axes.point(sweep)), velocity = twist.linear + lever;
    const Vec3 linear = axes.turned(sweep, velocity), angular = held.weld() ? axes.turned(sweep, twist.angular) : twist.angular;
    store_rows(sweep, held, rows, linear, angular, coordinate);
  };
  store(s, joint_of(s, p), -1);
  if (b.floating()) {
    SweepBuilder base = b.sweep("base_rows_" + held.name, equation, Direction::root);
    for (int j = 0; j < 6; ++j) store(base, unit_twist(base, j), j);
  }
  b.result({array, ir::Layout::columns, rows, held.first, held.frame.body});
}

// The rows' velocities, or, of an impact, what they shall become less what they are.
int row_velocities(Builder& b, const Held& held) {
  const Poses p = poses(b, held.poses());
  const RowAxes axes(b, held);
  const int role =
      b.role({"velocity_" + held.name, "Jcv", "velocity of contact " + held.contact->name, "m/s, rad/s", held.shape()});
  if (b.has("velocity_" + held.name)) return role;
  SweepBuilder s =
      b.sweep("velocity_" + held.name, held.weld() ? "J v = R [u + w x x; w]" : "J v = R (u + w x x)", Direction::root);
  const Vec3 u = s.of3(held.frame.body, p.velocity, 0), w = s.of3(held.frame.body, p.velocity, 3);
  const Vec3 lever = cross(w, axes.point(s)), velocity = u + lever;
  const Vec3 linear = axes.turned(s, velocity), angular = held.weld() ? axes.turned(s, w) : w;
  store_rows(s, held, role, linear, angular);
  return role;
}

// J̇ v. Along the link's axes: the spatial acceleration, for these turn with the link.
int row_biases(Builder& b, const Held& held) {
  const Poses p = poses(b, held.poses());
  const int of_bodies = bias_accelerations(b, held.poses() == Frame::base);
  const RowAxes axes(b, held);
  const int role =
      b.role({"bias_" + held.name, "dJcv", "dJ/dt v of contact " + held.contact->name, "m/s^2, rad/s^2", held.shape()});
  if (b.has("bias_" + held.name)) return role;
  SweepBuilder s = b.sweep(
      "bias_" + held.name,
      held.contact->along_link ? "dJ v = R [a + alpha x x; alpha]" : "dJ v = R [a + alpha x x + w x (u + w x x); alpha]",
      Direction::root);
  const int body = held.frame.body;
  const Vec3 a = s.of3(body, of_bodies, 0), alpha = s.of3(body, of_bodies, 3), x = axes.point(s);
  const Vec3 tangential = cross(alpha, x);
  Vec3 linear = a + tangential;
  if (!held.contact->along_link) {
    const Vec3 u = s.of3(body, p.velocity, 0), w = s.of3(body, p.velocity, 3);
    const Vec3 lever = cross(w, x), velocity = u + lever, centripetal = cross(w, velocity);
    linear = linear + centripetal;
  }
  const Vec3 turned = axes.turned(s, linear), angular = held.weld() ? axes.turned(s, alpha) : alpha;
  store_rows(s, held, role, turned, angular);
  return role;
}

// How far the contact is from its anchor, along the rows' axes: x − x₀, and ½ Σ aᵢ × rᵢ over the axes of anchor and link.
int row_errors(Builder& b, const Held& held) {
  const LinkPlace at = link_place(b, held.frame, Frame::base), base = base_in_world(b);
  const int role =
      b.role({"error_" + held.name, "ec", "from its anchor to contact " + held.contact->name, "m, rad", held.shape()});
  if (b.has("error_" + held.name)) return role;
  SweepBuilder s = b.sweep("error_" + held.name, "e = x - x0, and half the sum of a_i x r_i", Direction::root);
  const Mat3 to_world =
      b.floating() ? three_columns(s, -1, base.axes) : s.constant(Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
  const Mat3 in_base = three_columns(s, -1, at.axes), own = to_world * in_base;
  const Vec3 offset = to_world * s.of3(-1, at.origin), place = s.of3(-1, base.origin) + offset;
  const auto given = [&](int component) { return s.contact(held.index, component); };
  const Vec3 wanted{given(ir::contact_anchor), given(ir::contact_anchor + 1), given(ir::contact_anchor + 2)};
  Vec3 linear = place - wanted;
  Vec3 angular = s.zero();
  if (held.weld()) {
    const Mat3 anchor = base_rotation([&](int i) { return given(ir::contact_anchor + 3 + i); },
                                      [&](double value) { return s.constant(value); });
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 from = column(anchor, i), to = column(own, i), turning = cross(from, to);
      angular = angular + turning;
    }
    const Sym half = s.constant(0.5);
    angular = half * angular;
  }
  if (held.contact->along_link) {
    linear = transpose(own) * linear;
    if (held.weld()) angular = transpose(own) * angular;
  }
  store_rows(s, held, role, linear, angular);
  return role;
}

// What the rows' accelerations shall be less J̇ v: − J̇ v − kd J v − kp e. Of an impact: − (1 + restitution) J v.
void describe_right(Builder& b, const Held& held, bool impact, int array) {
  const std::string name = (impact ? "bounce_" : "right_") + held.name;
  const int velocity = row_velocities(b, held), bias = impact ? -1 : row_biases(b, held),
            error = impact ? -1 : row_errors(b, held);
  const int role = b.role({name, "bc", "what J dv of contact " + held.contact->name + " shall be",
                           impact ? "m/s, rad/s" : "m/s^2, rad/s^2", held.shape()});
  SweepBuilder s = b.sweep(name, impact ? "b = -(1 + restitution) J v" : "b = -(dJ v + kd J v + kp e)", Direction::root);
  for (int i = 0; i < held.contact->rows(); ++i) {
    if (impact) {
      const Sym one = s.constant(1), restitution = s.contact(held.index, ir::contact_restitution), whole = one + restitution;
      const Sym now = s.of(-1, velocity, i);
      s.store(role, i, -(whole * now));
    } else {
      const Sym kd = s.contact(held.index, ir::contact_kd), rate = s.of(-1, velocity, i), damped = kd * rate;
      const Sym kp = s.contact(held.index, ir::contact_kp), distance = s.of(-1, error, i), drawn = kp * distance;
      const Sym own = s.of(-1, bias, i);
      s.store(role, i, -(own + damped + drawn));
    }
  }
  b.result({array, ir::Layout::base, role, held.first});
}

// The output, or an array that is none; made once.
template <class Describe>
int array_of(Builder& b, ir::Quantity quantity, const std::string& name, int rows, int columns, const Describe& describe) {
  if (b.function().computes(quantity)) return b.output(quantity);
  const std::string own = b.own_name(name);
  if (const int made = b.array_called(own); made >= 0) return made;
  const int array = b.internal_array(own, rows, columns);
  describe(array);
  return array;
}

int jacobian(Builder& b) {
  return array_of(b, ir::Quantity::constraint_jacobian, "rows", b.tree().constraint_rows, b.tree().nv(),
                  [&](int array) { describe_constraint_jacobian(b, array); });
}

ir::ConstraintStep step(Builder& b, ir::ConstraintStep::Kind kind, int to) {
  const TreeFactors factors = tree_factors(b);
  const std::string name = b.own_name("constraint_room");
  const int made = b.array_called(name);
  ir::ConstraintStep s{kind, ir::constraint_paths(b.tree(), b.scene())};
  s.solutions = b.scene().scalar == ir::ScalarType::float32 ? Proximal<float>::steps : Proximal<double>::steps;
  s.jacobian = jacobian(b);
  s.factor = factors.upper;
  s.pivots = factors.pivots;
  s.room = made >= 0 ? made : b.internal_array(name, ir::constraint_room(s.paths), 1);
  s.to = to;
  return s;
}

}  // namespace

void describe_constraint_jacobian(Builder& b, int array) {
  for (const Held& held : held_links(b)) describe_rows(b, held, array);
}

void describe_constraint_bias(Builder& b, int array) {
  for (const Held& held : held_links(b)) b.result({array, ir::Layout::base, row_biases(b, held), held.first});
}

void describe_delassus_matrix(Builder& b, int array) {
  guard(b, array);
  b.constraint_step(step(b, ir::ConstraintStep::Kind::delassus, array));
}

namespace {

// v, of every coordinate.
int speeds(Builder& b) {
  const int role = b.role({"speed", "v", "v", "m/s or rad/s", Shape::scalar});
  if (b.has("speeds")) return role;
  SweepBuilder s = b.sweep("speeds", "v", Direction::anywhere);
  const Sym own = s.parameter(own_coordinate_p), rate = s.rate();
  s.store(role, own * rate);
  if (!b.floating()) return role;
  SweepBuilder base = b.sweep("base_speeds", "v", Direction::root);
  const Twist twist = base.base_twist();
  for (int j = 0; j < 6; ++j) {
    const auto at = static_cast<std::size_t>(j % 3);
    base.store(role, 0, j < 3 ? twist.linear[at] : twist.angular[at], j);
  }
  return role;
}

}  // namespace

void describe_impact(Builder& b, int array) {
  guard(b, array);
  b.result({array, ir::Layout::per_coordinate, speeds(b)});
  ir::ConstraintStep s = step(b, ir::ConstraintStep::Kind::impact, array);
  s.right = b.internal_array(b.own_name("bounce"), b.tree().constraint_rows, 1);
  s.forces = b.internal_array(b.own_name("impulses"), b.tree().constraint_rows, 1);
  for (const Held& held : held_links(b)) describe_right(b, held, true, s.right);
  b.constraint_step(s);
}

namespace {

// Accelerations and forces come of one step, whichever is asked for.
void solve_constrained(Builder& b) {
  for (const ir::ConstraintStep& made : b.constraint_steps())
    if (made.kind == ir::ConstraintStep::Kind::solve) return;
  const int rows = b.tree().constraint_rows;
  const auto nothing = [](int) {};
  const int to = array_of(b, ir::Quantity::constrained_forward_dynamics, "constrained_accelerations", b.tree().nv(), 1, nothing);
  ir::ConstraintStep s = step(b, ir::ConstraintStep::Kind::solve, to);
  s.forces = array_of(b, ir::Quantity::constraint_forces, "forces", rows, 1, nothing);
  s.right = b.internal_array(b.own_name("right"), rows, 1);
  b.result({to, ir::Layout::per_coordinate, unbalanced(b)});
  for (const Held& held : held_links(b)) describe_right(b, held, false, s.right);
  b.constraint_step(s);
}

}  // namespace

void describe_constrained_forward_dynamics(Builder& b, int array) {
  guard(b, array);
  solve_constrained(b);
}

void describe_constraint_forces(Builder& b, int array) {
  guard(b, array);
  solve_constrained(b);
}

}  // namespace dalembert::passes
