// Rows of contacts and loops, J v̇ + J̇ v = b, and what keeps to them.
#include <algorithm>
#include <numeric>

#include "dalembert/chain_shapes.hpp"
#include "dalembert/constraint_shapes.hpp"
#include "ir/constraint_step.hpp"
#include "passes/quantities/constraint_rows.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::Shape;

namespace {

// What the rows' accelerations shall be less J̇ v: − J̇ v − kd J v − kp e. Of an impact: − (1 + restitution) J v.
void describe_right(Builder& b, const ConstraintRows& rows, bool impact, int array) {
  const std::string name = (impact ? "bounce_" : "right_") + rows.name();
  const RowRoles velocity = rows.velocities(b), bias = impact ? RowRoles{} : rows.biases(b),
                 error = impact ? RowRoles{} : rows.errors(b);
  const int count = rows.constraint().rows;
  std::vector<int> roles;
  if (count == 3 || count == 6) {
    const int role = b.role({name, "bc", "what J dv of " + rows.constraint().of + " shall be",
                             impact ? "m/s, rad/s" : "m/s^2, rad/s^2", count == 6 ? Shape::wrench : Shape::vector});
    roles.assign(static_cast<std::size_t>(count), role);
  } else {
    for (int i = 0; i < count; ++i)
      roles.push_back(b.role({name + "_row_" + std::to_string(i), "bc" + std::to_string(i),
                              "what J dv of " + rows.constraint().of + " shall be", impact ? "m/s, rad/s" : "m/s^2, rad/s^2",
                              Shape::scalar}));
  }
  const bool together = count == 3 || count == 6;
  SweepBuilder s = b.sweep_of_base(name, impact ? "b = -(1 + restitution) J v" : "b = -(dJ v + kd J v + kp e)");
  for (int i = 0; i < count; ++i) {
    const auto row = static_cast<std::size_t>(i);
    const auto of = [&](const RowRoles& values) { return s.of(-1, values[row].first, values[row].second); };
    Sym right;
    if (impact) {
      const Sym one = s.constant(1), restitution = s.constraint(rows.index(), ir::contact_restitution),
                whole = one + restitution;
      const Sym now = of(velocity);
      right = -(whole * now);
    } else {
      const Sym kd = s.constraint(rows.index(), ir::contact_kd), rate = of(velocity), damped = kd * rate;
      const Sym kp = s.constraint(rows.index(), ir::contact_kp), distance = of(error), drawn = kp * distance;
      const Sym own = of(bias);
      right = -(own + damped + drawn);
    }
    s.store(roles[row], together ? i : 0, right);
    if (!together) b.result({array, ir::Layout::base, roles[row], rows.first() + i});
  }
  if (together) b.result({array, ir::Layout::base, roles.front(), rows.first()});
}

// The output, or an array that is none; made once.
template <class Describe>
int array_of(Builder& b, ir::Quantity quantity, const std::string& name, int rows, int columns, const Describe& describe) {
  if (b.computes(quantity)) return b.output(quantity);
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

// Whether derivatives are asked for.
bool responds(const Builder& b) {
  constexpr ir::Quantity derivatives[] = {ir::Quantity::constrained_forward_dynamics_dq,
                                          ir::Quantity::constrained_forward_dynamics_dv,
                                          ir::Quantity::constrained_forward_dynamics_dtau,
                                          ir::Quantity::constraint_forces_dq,
                                          ir::Quantity::constraint_forces_dv,
                                          ir::Quantity::constraint_forces_dtau};
  return std::any_of(std::begin(derivatives), std::end(derivatives), [&](ir::Quantity q) { return b.computes(q); });
}
// Room to work in, made once.
int room_called(Builder& b, const std::string& name, int size) {
  const std::string own = b.own_name(name);
  const int made = b.array_called(own);
  return made >= 0 ? made : b.internal_array(own, size, 1);
}
int room_of_response(Builder& b) { return room_called(b, "response", response_room(b.tree().nv(), b.tree().constraint_rows)); }

// Whether rows go up their limbs body by body, by articulated bodies, and neither M nor its factors are formed. A loop has two
// limbs; on a fixed base joints are not along the base's axes; derivatives have M⁻¹ of all joints anyhow.
bool by_limbs(const Builder& b) { return b.base_coordinates() > 0 && !b.factors() && b.scene().loops.empty() && !responds(b); }

// J's columns of the base: along its axes and about its origin, what the rows push it with.
int base_columns(Builder& b) {
  if (b.computes(ir::Quantity::constraint_jacobian)) return b.output(ir::Quantity::constraint_jacobian);
  if (const int made = b.array_called(b.own_name("rows")); made >= 0) return made;
  const std::string name = b.own_name("row_wrenches");
  if (const int made = b.array_called(name); made >= 0) return made;
  std::vector<int> columns(static_cast<std::size_t>(b.tree().nv()), -1);
  std::iota(columns.begin(), columns.begin() + 6, 0);
  const int array = b.internal_array_of_part(name, b.tree().constraint_rows, 6, {}, columns);
  describe_constraint_jacobian(b, array);
  return array;
}

ir::ConstraintStep step(Builder& b, ir::ConstraintStep::Kind kind, int to) {
  ir::ConstraintStep s{kind, ir::constraint_paths(b.tree(), b.scene())};
  s.solutions = b.scene().scalar == ir::ScalarType::float32 ? Proximal<float>::steps : Proximal<double>::steps;
  if (by_limbs(b)) {
    const GainArrays gains = gain_arrays(b);
    s.jacobian = base_columns(b);
    s.pivots = b.guard()->pivots;
    s.gain = gains.gain;
    s.joint = gains.joint;
  } else {
    const TreeFactors factors = tree_factors(b);
    s.jacobian = jacobian(b);
    s.factor = factors.upper;
    s.pivots = factors.pivots;
  }
  s.room = room_called(b, "constraint_room", ir::constraint_room(s.paths));
  s.to = to;
  return s;
}

}  // namespace

void describe_constraint_jacobian(Builder& b, int array) {
  for (const auto& rows : constraint_rows(b)) rows->columns(b, array);
}

void describe_constraint_bias(Builder& b, int array) {
  for (const auto& rows : constraint_rows(b)) {
    const RowRoles roles = rows->biases(b);
    for (std::size_t i = 0; i < roles.size(); ++i) {
      const int row = rows->first() + static_cast<int>(i);
      if (roles[i].second == 0) b.result({array, ir::Layout::base, roles[i].first, row});
    }
  }
}

void describe_delassus_matrix(Builder& b, int array) {
  guard(b, array);
  b.step(step(b, ir::ConstraintStep::Kind::delassus, array));
}

namespace {

// v, of every coordinate.
int speeds(Builder& b) {
  const int role = b.role({"speed", "v", "v", "m/s or rad/s", Shape::scalar});
  if (b.has("speeds")) return role;
  SweepBuilder s = b.sweep("speeds", "v", Direction::anywhere);
  const Sym own = s.parameter(own_coordinate_p), rate = s.rate();
  s.store(role, own * rate);
  if (b.base_coordinates() == 0) return role;
  SweepBuilder base = b.sweep_of_base("base_speeds", "v");
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
  for (const auto& rows : constraint_rows(b)) describe_right(b, *rows, true, s.right);
  b.step(s);
}

namespace {

// Accelerations and forces come of one step, whichever is asked for.
ir::ConstraintStep solve_constrained(Builder& b) {
  if (const auto made = b.made(ir::ConstraintStep::Kind::solve)) return *made;
  const int rows = b.tree().constraint_rows;
  const auto nothing = [](int) {};
  const int to =
      array_of(b, ir::Quantity::constrained_forward_dynamics, "constrained_accelerations", b.tree().nv(), 1, nothing);
  ir::ConstraintStep s = step(b, ir::ConstraintStep::Kind::solve, to);
  s.forces = array_of(b, ir::Quantity::constraint_forces, "forces", rows, 1, nothing);
  s.right = b.internal_array(b.own_name("right"), rows, 1);
  if (responds(b)) s.response = room_of_response(b);
  b.result({to, ir::Layout::per_coordinate, s.by_limbs() ? solved_accelerations(b).free_acceleration : unbalanced(b)});
  for (const auto& rows : constraint_rows(b)) describe_right(b, *rows, false, s.right);
  b.step(s);
  return s;
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

namespace {

constexpr ir::Quantity of_accelerations[] = {ir::Quantity::constrained_forward_dynamics_dq,
                                             ir::Quantity::constrained_forward_dynamics_dv},
                       of_forces[] = {ir::Quantity::constraint_forces_dq, ir::Quantity::constraint_forces_dv};

int rows_of(const Builder& b) { return b.tree().constraint_rows; }

// N as M⁻¹ has it for products, and what else tells how the robot responds.
ir::ConstraintStep response(Builder& b) {
  if (const auto made = b.made(ir::ConstraintStep::Kind::respond)) return *made;
  const bool solved = b.computes(ir::Quantity::constrained_forward_dynamics) || b.computes(ir::Quantity::constraint_forces);
  if (solved) solve_constrained(b);
  const int inverse = padded_inverse(b);
  ir::ConstraintStep s{ir::ConstraintStep::Kind::respond, ir::constraint_paths(b.tree(), b.scene())};
  s.solutions = b.scene().scalar == ir::ScalarType::float32 ? Proximal<float>::steps : Proximal<double>::steps;
  s.jacobian = jacobian(b);
  s.inverse = inverse;
  s.room = room_of_response(b);
  const auto solve = b.made(ir::ConstraintStep::Kind::solve);
  s.inverted = solve && solve->response == s.room;
  s.to = b.internal_array(b.own_name("projected_inverse"), inverse_size(b.tree().nv()), 1);
  const auto output = [&](ir::Quantity quantity) { return b.computes(quantity) ? b.output(quantity) : -1; };
  s.plain = output(ir::Quantity::constrained_forward_dynamics_dtau);
  s.forces = output(ir::Quantity::constraint_forces_dtau);
  s.of_forces = s.forces >= 0 || b.computes(of_forces[0]) || b.computes(of_forces[1]);
  b.step(s);
  return s;
}

// Behind v̇ and forces: by q, or by v.
void derive(Builder& b, bool by_q) {
  const std::size_t by = by_q ? 0 : 1;
  const std::string efforts_name = b.own_name(by_q ? "efforts_dq" : "efforts_dv");
  if (b.has_array(efforts_name)) return;
  const int nv = b.tree().nv(), rows = rows_of(b);
  const ir::ConstraintStep r = response(b);
  const auto output = [&](ir::Quantity quantity) { return b.computes(quantity) ? b.output(quantity) : -1; };
  ir::ConstraintStep s{ir::ConstraintStep::Kind::derive, ir::constraint_paths(b.tree(), b.scene())};
  s.room = r.room;
  s.inverse = r.to;
  s.to = output(of_accelerations[by]);
  s.forces = output(of_forces[by]);
  s.efforts = b.internal_array(efforts_name, nv, nv);
  s.changes = b.internal_array(b.own_name(by_q ? "changes_dq" : "changes_dv"), rows, nv);
  (by_q ? describe_inverse_dynamics_dq : describe_inverse_dynamics_dv)(b, s.efforts);
  const auto all = constraint_rows(b);
  for (const auto& own : all) own->changes(b, by_q, s.changes);
  // Efforts do not depend on where the base is.
  s.first = by_q && b.base_coordinates() > 0 ? 3 : 0;
  if (s.to >= 0) b.step({ir::MatrixStep::Kind::negative_product, r.to, s.efforts, s.to, -1, s.first});
  if (by_q && !b.scene().loops.empty()) {
    s.turning_rows = turning_rows * static_cast<int>(b.scene().loops.size());
    s.left = b.internal_array(b.own_name("turning"), s.turning_rows, nv);
    s.turned = b.internal_array(b.own_name("turned"), s.turning_rows, nv);
    s.turning_room = b.internal_array(b.own_name("turning_room"), turning_room(nv, rows, s.turning_rows), 1);
    int row = 0;
    for (const auto& own : all) {
      if (!own->constraint().loop) continue;
      own->turning(b, s.left, s.turned, row);
      row += turning_rows;
    }
  }
  b.step(s);
}

// What is differentiated has to be there.
void describe_derivative(Builder& b, ir::Quantity quantity, int array, bool by_q) {
  guard(b, array);
  const ir::ConstraintStep solved = solve_constrained(b);
  response(b);
  b.behind("constrained_derivatives", "ConstrainedDerivatives", solved.to, solved.forces, quantity, [=](Builder& next) {
    guard(next, array);
    derive(next, by_q);
  });
}

}  // namespace

void describe_constrained_forward_dynamics_dq(Builder& b, int array) {
  describe_derivative(b, ir::Quantity::constrained_forward_dynamics_dq, array, true);
}

void describe_constrained_forward_dynamics_dv(Builder& b, int array) {
  describe_derivative(b, ir::Quantity::constrained_forward_dynamics_dv, array, false);
}

void describe_constraint_forces_dq(Builder& b, int array) {
  describe_derivative(b, ir::Quantity::constraint_forces_dq, array, true);
}

void describe_constraint_forces_dv(Builder& b, int array) {
  describe_derivative(b, ir::Quantity::constraint_forces_dv, array, false);
}

void describe_constrained_forward_dynamics_dtau(Builder& b, int array) {
  guard(b, array);
  response(b);
}

void describe_constraint_forces_dtau(Builder& b, int array) {
  guard(b, array);
  response(b);
}

namespace {

// Whether the base floats and is all that has no motor: what contacts bear is a wrench on it, which reaches joints along their
// axes. The force of a loop is two wrenches.
bool base_alone_is_undriven(const Builder& b, const std::vector<int>& undriven) {
  const auto& bodies = b.tree().bodies;
  return b.base_coordinates() == 6 && undriven.size() == 6 && b.scene().loops.empty() &&
         std::none_of(bodies.begin(), bodies.end(), [](const auto& body) { return body.driven(); });
}

// Axes of the joints above constraints, in the base's axes about its origin.
int joint_axes(Builder& b, const std::vector<int>& moving) {
  std::vector<int> columns(static_cast<std::size_t>(b.tree().nv()), -1);
  int count = 0;
  for (const int k : moving)
    if (k >= 6) columns[static_cast<std::size_t>(k)] = count++;
  const int array = b.internal_array_of_part(b.own_name("joint_axes"), 6, std::max(count, 1), {}, columns);
  const Poses p = poses(b);
  b.result({array, ir::Layout::columns, p.joint_linear});
  b.result({array, ir::Layout::columns, p.joint_angular, 3});
  return array;
}

// Torques and forces come of one step, whichever is asked for.
void support(Builder& b) {
  if (b.made(ir::ConstraintStep::Kind::support)) return;
  const auto nothing = [](int) {};
  const int to = array_of(b, ir::Quantity::constrained_inverse_dynamics, "efforts", b.tree().nv(), 1, nothing);
  ir::ConstraintStep s{ir::ConstraintStep::Kind::support, ir::constraint_paths(b.tree(), b.scene())};
  s.solutions = b.scene().scalar == ir::ScalarType::float32 ? Proximal<float>::steps : Proximal<double>::steps;
  s.undriven = ir::undriven_coordinates(b.tree(), b.scene());
  if (base_alone_is_undriven(b, s.undriven)) {
    s.jacobian = base_columns(b);
    s.axes = joint_axes(b, s.paths.moving());
  } else {
    s.jacobian = jacobian(b);
  }
  s.forces = array_of(b, ir::Quantity::inverse_constraint_forces, "borne", b.tree().constraint_rows, 1, nothing);
  s.to = to;
  const NewtonEuler all = newton_euler(b, Driven::accelerated);
  b.result({to, ir::Layout::per_coordinate, less_external(b, all.torque, all.subtree_wrench)});
  b.step(s);
}

}  // namespace

void describe_constrained_inverse_dynamics(Builder& b, int) { support(b); }

void describe_inverse_constraint_forces(Builder& b, int) { support(b); }

}  // namespace dalembert::passes
