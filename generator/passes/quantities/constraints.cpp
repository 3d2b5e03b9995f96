// Rows of contacts and loops, J v̇ + J̇ v = b, and what keeps to them.
#include <algorithm>
#include <numeric>

#include "dalembert/chain_shapes.hpp"
#include "dalembert/constraint_shapes.hpp"
#include "ir/constraint_paths.hpp"
#include "passes/quantities/constraint_rows.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::Operand;
using ir::Shape;
using Kind = ir::Kernel::Kind;

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
      roles.push_back(b.role({"row_" + std::to_string(i) + "_" + name, "bc" + std::to_string(i),
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
int response_array(Builder& b) { return room_called(b, "response", response_room(b.tree().nv(), b.tree().constraint_rows)); }

ir::Kernel kernel_of_constraints(const Builder& b, Kind kind) {
  ir::Kernel kernel(kind);
  kernel.paths = ir::constraint_paths(b.tree(), b.scene());
  const auto as = [&](auto proximal) {
    kernel.solutions = proximal.steps, kernel.mu = proximal.mu, kernel.unmoved = proximal.unmoved;
    kernel.least = proximal.least, kernel.largest = proximal.largest, kernel.smallest = proximal.smallest;
  };
  if (b.scene().scalar == ir::ScalarType::float32) as(Proximal<float>());
  else as(Proximal<double>());
  return kernel;
}

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

// By M's factors, or by limbs.
ir::Kernel kernel_of_rows(Builder& b, Kind by_factors, Kind going_up_limbs, int to) {
  ir::Kernel kernel = kernel_of_constraints(b, by_limbs(b) ? going_up_limbs : by_factors);
  if (kernel.by_limbs()) {
    const GainArrays gains = gain_arrays(b);
    kernel[Operand::jacobian] = base_columns(b);
    kernel[Operand::pivots] = b.guard()->pivots;
    kernel[Operand::gain] = gains.gain;
    kernel[Operand::joint] = gains.joint;
  } else {
    const TreeFactors factors = tree_factors(b);
    kernel[Operand::jacobian] = jacobian(b);
    kernel[Operand::factor] = factors.upper;
    kernel[Operand::pivots] = factors.pivots;
  }
  kernel[Operand::room] = room_called(b, "constraint_room", ir::constraint_room(kernel.paths));
  kernel[Operand::to] = to;
  return kernel;
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
  b.kernel(kernel_of_rows(b, Kind::delassus, Kind::delassus_by_limbs, array));
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
  ir::Kernel impact = kernel_of_rows(b, Kind::impact, Kind::impact_by_limbs, array);
  impact[Operand::right] = b.internal_array(b.own_name("bounce"), b.tree().constraint_rows, 1);
  impact[Operand::forces] = b.internal_array(b.own_name("impulses"), b.tree().constraint_rows, 1);
  for (const auto& rows : constraint_rows(b)) describe_right(b, *rows, true, impact[Operand::right]);
  b.kernel(impact);
}

namespace {

// Accelerations and forces come of one kernel, whichever is asked for.
ir::Kernel solve_constrained(Builder& b) {
  if (const auto made = b.made({Kind::solve_constrained, Kind::solve_constrained_by_limbs})) return *made;
  const int rows = b.tree().constraint_rows;
  const auto nothing = [](int) {};
  const int to =
      array_of(b, ir::Quantity::constrained_forward_dynamics, "constrained_accelerations", b.tree().nv(), 1, nothing);
  ir::Kernel solve = kernel_of_rows(b, Kind::solve_constrained, Kind::solve_constrained_by_limbs, to);
  solve[Operand::forces] = array_of(b, ir::Quantity::constraint_forces, "forces", rows, 1, nothing);
  solve[Operand::right] = b.internal_array(b.own_name("right"), rows, 1);
  if (responds(b)) solve[Operand::response] = response_array(b);
  b.result({to, ir::Layout::per_coordinate, solve.by_limbs() ? solved_accelerations(b).free_acceleration : unbalanced(b)});
  for (const auto& own : constraint_rows(b)) describe_right(b, *own, false, solve[Operand::right]);
  b.kernel(solve);
  return solve;
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
ir::Kernel response(Builder& b) {
  if (const auto made = b.made({Kind::respond, Kind::respond_as_solved})) return *made;
  const bool solved = b.computes(ir::Quantity::constrained_forward_dynamics) || b.computes(ir::Quantity::constraint_forces);
  if (solved) solve_constrained(b);
  const int inverse = padded_inverse(b);
  const bool goes_on = b.made({Kind::solve_constrained}).has_value();
  ir::Kernel respond = kernel_of_constraints(b, goes_on ? Kind::respond_as_solved : Kind::respond);
  respond[Operand::jacobian] = jacobian(b);
  respond[Operand::inverse] = inverse;
  respond[Operand::response] = response_array(b);
  respond[Operand::to] = b.internal_array(b.own_name("projected_inverse"), inverse_size(b.tree().nv()), 1);
  const auto output = [&](ir::Quantity quantity) { return b.computes(quantity) ? b.output(quantity) : -1; };
  respond[Operand::plain] = output(ir::Quantity::constrained_forward_dynamics_dtau);
  respond[Operand::forces] = output(ir::Quantity::constraint_forces_dtau);
  respond.of_forces = respond[Operand::forces] >= 0 || b.computes(of_forces[0]) || b.computes(of_forces[1]);
  b.kernel(respond);
  return respond;
}

// Behind v̇ and forces: by q, or by v.
void derive(Builder& b, bool by_q) {
  const std::size_t by = by_q ? 0 : 1;
  const std::string efforts_name = b.own_name(by_q ? "efforts_dq" : "efforts_dv");
  if (b.has_array(efforts_name)) return;
  const int nv = b.tree().nv(), rows = rows_of(b);
  const ir::Kernel respond = response(b);
  const int inverse = respond[Operand::to];
  const auto output = [&](ir::Quantity quantity) { return b.computes(quantity) ? b.output(quantity) : -1; };
  ir::Kernel derive = kernel_of_constraints(b, Kind::derive);
  derive[Operand::response] = respond[Operand::response];
  derive[Operand::inverse] = inverse;
  const int to = derive[Operand::to] = output(of_accelerations[by]);
  derive[Operand::forces] = output(of_forces[by]);
  const int efforts = derive[Operand::efforts] = b.internal_array(efforts_name, nv, nv);
  const int changes = derive[Operand::changes] = b.internal_array(b.own_name(by_q ? "changes_dq" : "changes_dv"), rows, nv);
  (by_q ? describe_inverse_dynamics_dq : describe_inverse_dynamics_dv)(b, efforts);
  const auto all = constraint_rows(b);
  for (const auto& own : all) own->changes(b, by_q, changes);
  // Efforts do not depend on where the base is.
  derive.first = by_q && b.base_coordinates() > 0 ? 3 : 0;
  if (to >= 0) negative_product(b, inverse, efforts, to, derive.first);
  if (by_q && !b.scene().loops.empty()) {
    const int count = derive.turning_rows = turning_rows * static_cast<int>(b.scene().loops.size());
    const int left = derive[Operand::left] = b.internal_array(b.own_name("turning"), count, nv);
    const int turned = derive[Operand::turned] = b.internal_array(b.own_name("turned"), count, nv);
    derive[Operand::turning_room] = b.internal_array(b.own_name("turning_room"), turning_room(nv, rows, count), 1);
    int row = 0;
    for (const auto& own : all) {
      if (!own->constraint().loop) continue;
      own->turning(b, left, turned, row);
      row += turning_rows;
    }
  }
  b.kernel(derive);
}

// What is differentiated has to be there.
void describe_derivative(Builder& b, ir::Quantity quantity, int array, bool by_q) {
  guard(b, array);
  const ir::Kernel solved = solve_constrained(b);
  response(b);
  b.behind("constrained_derivatives", "ConstrainedDerivatives", solved[Operand::to], solved[Operand::forces], quantity,
           [=](Builder& next) {
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

// Whether all rows are along the world's axes.
bool along_world(const Builder& b) {
  const auto& contacts = b.scene().contacts;
  return std::none_of(contacts.begin(), contacts.end(), [](const auto& contact) { return contact.along_link; });
}

void points_in_world(Builder& b, ir::Kernel& kernel) {
  const auto all = constraint_rows(b);
  kernel[Operand::points] = b.internal_array(b.own_name("points"), 3, static_cast<int>(all.size()));
  kernel[Operand::turn] = b.internal_array(b.own_name("base_in_world"), 3, 3);
  for (const auto& rows : all)
    b.result({kernel[Operand::points], ir::Layout::base, rows->point_in_world(b), 3 * rows->index()});
  b.result({kernel[Operand::turn], ir::Layout::base, base_in_world(b).axes});
}

// Torques and forces come of one kernel, whichever is asked for.
void support(Builder& b) {
  if (b.made({Kind::support, Kind::support_by_wrenches, Kind::support_at_points})) return;
  const auto nothing = [](int) {};
  const int to = array_of(b, ir::Quantity::constrained_inverse_dynamics, "efforts", b.tree().nv(), 1, nothing);
  const std::vector<int> undriven = ir::undriven_coordinates(b.tree(), b.scene());
  const bool by_wrenches = base_alone_is_undriven(b, undriven);
  const bool at_points = by_wrenches && along_world(b);
  ir::Kernel support = kernel_of_constraints(b, at_points     ? Kind::support_at_points
                                                : by_wrenches ? Kind::support_by_wrenches
                                                              : Kind::support);
  support.undriven = undriven;
  support.base_undriven = b.base_coordinates();
  if (at_points) points_in_world(b, support);
  else support[Operand::jacobian] = by_wrenches ? base_columns(b) : jacobian(b);
  if (by_wrenches) support[Operand::axes] = joint_axes(b, support.paths.moving());
  support[Operand::forces] =
      array_of(b, ir::Quantity::inverse_constraint_forces, "borne", b.tree().constraint_rows, 1, nothing);
  support[Operand::to] = to;
  const NewtonEuler all = newton_euler(b, Driven::accelerated);
  b.result({to, ir::Layout::per_coordinate, less_external(b, all.torque, all.subtree_wrench)});
  b.kernel(support);
}

}  // namespace

void describe_constrained_inverse_dynamics(Builder& b, int) { support(b); }

void describe_inverse_constraint_forces(Builder& b, int) { support(b); }

}  // namespace dalembert::passes
