#include "passes/builder.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "passes/joints.hpp"

namespace dalembert::passes {

using ir::InputKind;

ir::Sweep& SweepBuilder::sweep() { return builder_.algorithm_.sweeps[sweep_]; }

ir::Graph& SweepBuilder::graph() { return part_ == Part::whole ? sweep().graph : sweep().back->graph; }

SweepBuilder SweepBuilder::back() {
  sweep().back = ir::Back{builder_.new_graph()};
  return {builder_, sweep_, Part::back};
}

Sym SweepBuilder::constant(double value) { return {&graph(), graph().constant(value)}; }

Mat3 SweepBuilder::constant(const Eigen::Matrix3d& m) {
  return {constant(Eigen::Vector3d(m.row(0))), constant(Eigen::Vector3d(m.row(1))), constant(Eigen::Vector3d(m.row(2)))};
}

Sym SweepBuilder::input(InputKind kind, int index, int component, int body) {
  return {&graph(), graph().input({kind, index, component, body})};
}

Vec3 SweepBuilder::three(InputKind kind, int role, int from, int body) {
  return {input(kind, role, from, body), input(kind, role, from + 1, body), input(kind, role, from + 2, body)};
}

BodyConstants SweepBuilder::body(bool reference) {
  reference = reference && builder_.moves_reference();
  BodyConstants c;
  c.rotation = parameter9(reference ? pose_rotation_p : rotation_p);
  c.translation = parameter3(reference ? pose_translation_p : translation_p);
  c.turning = parameter(turning_p);
  c.sliding = parameter(sliding_p);
  c.mass = parameter(mass_p);
  c.first = parameter3(first_p);
  for (int i = 0; i < 6; ++i) c.second[static_cast<std::size_t>(i)] = parameter(second_p + i);
  c.half_second = parameter3(half_second_p);
  c.half_trace = parameter(half_trace_p);
  return c;
}

JointPosition SweepBuilder::position(bool reference) {
  const JointRoles roles = joint_roles(builder_, reference);
  return {own(roles.sine), own(roles.cosine), own(roles.slide)};
}

Twist SweepBuilder::joint_twist() {
  const BodyConstants constants = body();
  const Sym speed = rate();
  const Twist own = joint_motion(constants, parameter(moves_p) * speed);
  const Vec3 linear = parameter3(joint_twist_p), angular = parameter3(joint_twist_p + 3);
  return {own.linear + linear, own.angular + angular};
}

Sym SweepBuilder::coordinate() { return own(joint_position_role(builder_)); }
Sym SweepBuilder::rate() { return own(joint_rate_role(builder_)); }
Sym SweepBuilder::acceleration() { return own(joint_acceleration_role(builder_)); }
Sym SweepBuilder::effort() { return own(joint_effort_role(builder_)); }

Twist SweepBuilder::first_six(InputKind kind) {
  if (builder_.base_coordinates() == 0) return {zero(), zero()};
  Twist v;
  for (int i = 0; i < 3; ++i) {
    v.linear[static_cast<std::size_t>(i)] = input(kind, i);
    v.angular[static_cast<std::size_t>(i)] = input(kind, 3 + i);
  }
  return v;
}

Twist SweepBuilder::base_twist() {
  if (builder_.scene().rates_zero) return {zero(), zero()};
  return first_six(InputKind::velocity);
}

Twist SweepBuilder::base_acceleration() { return first_six(InputKind::acceleration); }
Twist SweepBuilder::base_effort() { return first_six(InputKind::effort); }

Twist SweepBuilder::external(int wrench) {
  Twist given;
  for (int i = 0; i < 3; ++i) {
    given.linear[static_cast<std::size_t>(i)] = input(InputKind::wrench, wrench, i);
    given.angular[static_cast<std::size_t>(i)] = input(InputKind::wrench, wrench, 3 + i);
  }
  return given;
}

Sym SweepBuilder::constraint(int constraint, int component) { return input(InputKind::constraint, constraint, component); }
Sym SweepBuilder::element(int array, int element) { return input(InputKind::element, array, element); }

Vec3 SweepBuilder::gravity_in_world() {
  switch (builder_.scene().gravity_kind) {
    case ir::GravityKind::none: break;
    case ir::GravityKind::constant: return constant(builder_.scene().gravity);
    case ir::GravityKind::run_time:
      return {input(InputKind::gravity, 0, 0), input(InputKind::gravity, 0, 1), input(InputKind::gravity, 0, 2)};
  }
  return zero();
}

Mat3 SweepBuilder::base_axes() {
  if (builder_.base_coordinates() == 0) return constant(Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
  return base_rotation([this](int i) { return input(InputKind::position, 3 + i); },
                       [this](double value) { return constant(value); });
}

Vec3 SweepBuilder::base_position() {
  if (builder_.base_coordinates() == 0) return zero();
  return {input(InputKind::position, 0), input(InputKind::position, 1), input(InputKind::position, 2)};
}

Vec3 SweepBuilder::gravity_in_base() {
  const Vec3 g = gravity_in_world();
  return builder_.base_coordinates() > 0 ? transpose(base_axes()) * g : g;
}

void SweepBuilder::store(int role, int component, Sym x, int coordinate) {
  ir::Sweep& s = sweep();
  (part_ == Part::whole  ? s.stores
   : part_ == Part::back ? s.back->stores
                         : s.back->at_reference)
      .push_back({role, component, x.id, coordinate});
}

void SweepBuilder::store(int role, const Vec3& x, int from, int coordinate) {
  for (int i = 0; i < 3; ++i) store(role, from + i, x[static_cast<std::size_t>(i)], coordinate);
}

void SweepBuilder::store(int role, const Twist& x, int coordinate) {
  store(role, x.linear, 0, coordinate);
  store(role, x.angular, 3, coordinate);
}

void SweepBuilder::hand_on(int role, int component, Sym x) { sweep().carries.push_back({role, component, x.id}); }

void SweepBuilder::hand_on(int role, const Vec3& x, int from) {
  for (int i = 0; i < 3; ++i) hand_on(role, from + i, x[static_cast<std::size_t>(i)]);
}

int Builder::role(const ir::Role& role) {
  auto& roles = algorithm_.roles;
  const auto at = std::find_if(roles.begin(), roles.end(), [&](const ir::Role& r) { return r.name == role.name; });
  if (at != roles.end()) {
    if (at->shape != role.shape || at->meaning != role.meaning) throw std::logic_error("two roles are called " + role.name);
    return static_cast<int>(at - roles.begin());
  }
  roles.push_back(role);
  return static_cast<int>(roles.size()) - 1;
}

bool Builder::has(const std::string& sweep) const {
  return std::any_of(algorithm_.sweeps.begin(), algorithm_.sweeps.end(), [&](const ir::Sweep& s) { return s.name == sweep; });
}

int Builder::array_called(const std::string& name) const {
  const auto at = std::find_if(algorithm_.arrays.begin(), algorithm_.arrays.end(),
                               [&](const ir::OutputArray& a) { return a.name == name; });
  return at == algorithm_.arrays.end() ? -1 : static_cast<int>(at - algorithm_.arrays.begin());
}

SweepBuilder Builder::sweep(const std::string& name, const std::string& equation, ir::Direction direction, ir::BodySet over) {
  algorithm_.sweeps.push_back({name, equation, over, direction, ir::Graph(options_)});
  return {*this, algorithm_.sweeps.size() - 1};
}

SweepBuilder Builder::sweep_of_base(const std::string& name, const std::string& equation) {
  return sweep(name, equation, ir::Direction::anywhere, ir::BodySet::base());
}

int Builder::array(const std::string& name, int rows, int columns) {
  algorithm_.arrays.push_back({name, rows, columns});
  return static_cast<int>(algorithm_.arrays.size()) - 1;
}

bool Builder::factors() const {
  return solver_ == ir::Solver::factorization || tree_.independent_joints() < tree_.joints() ||
         computes(ir::Quantity::mass_matrix_factor);
}

bool Builder::fills(int array) const {
  return std::any_of(algorithm_.pairs.begin(), algorithm_.pairs.end(), [=](const ir::Pairs& p) { return p.array == array; });
}

int Builder::output(ir::Quantity quantity) {
  const std::string name = algorithm_.function.result(quantity);
  if (const int made = array_called(name); made >= 0) return made;
  const ir::QuantityRow& row = ir::row_of(quantity);
  const ir::Part* const part = algorithm_.function.part(quantity);
  const int rows = ir::extent(row.rows, tree_, part), columns = ir::extent(row.columns, tree_, part);
  return array_of_part(name, rows, columns, ir::map_of(part, row.rows, tree_), ir::map_of(part, row.columns, tree_));
}

int Builder::array_of_part(const std::string& name, int rows, int columns, std::vector<int> row_map,
                           std::vector<int> column_map) {
  const int index = array(name, rows, columns);
  algorithm_.arrays.back().row_map = std::move(row_map);
  algorithm_.arrays.back().column_map = std::move(column_map);
  return index;
}

int Builder::internal_array(const std::string& name, int rows, int columns) {
  const int index = array(name, rows, columns);
  algorithm_.arrays.back().internal = true;
  return index;
}

int Builder::internal_array_of_part(const std::string& name, int rows, int columns, std::vector<int> row_map,
                                    std::vector<int> column_map) {
  const int index = array_of_part(name, rows, columns, std::move(row_map), std::move(column_map));
  algorithm_.arrays.back().internal = true;
  return index;
}

std::optional<ir::Kernel> Builder::made(std::initializer_list<ir::Kernel::Kind> kinds) const {
  const auto in = [&](const ir::Algorithm& section) -> std::optional<ir::Kernel> {
    const auto at = std::find_if(section.kernels.begin(), section.kernels.end(), [&](const ir::Kernel& kernel) {
      return std::find(kinds.begin(), kinds.end(), kernel.kind) != kinds.end();
    });
    return at == section.kernels.end() ? std::nullopt : std::optional(*at);
  };
  for (const ir::Algorithm& section : before_)
    if (const auto found = in(section)) return found;
  return in(algorithm_);
}

void Builder::behind(const std::string& name, const std::string& type, int accelerations, int forces, ir::Quantity quantity,
                     const std::function<void(Builder&)>& describe) {
  const ir::EmittedFunction& function = algorithm_.function;
  behind_.push_back(
      {{0, function.own_name(name), function.type + type, ir::Function::inverse_dynamics, {}, accelerations, forces},
       quantity,
       describe});
}

// The section is complete.
void Builder::end_section(ir::Algorithm next) {
  for (ir::Sweep& sweep : algorithm_.sweeps) sweep.first_at_its_joint = sweep.first_at_its_joint && !keeps_moments_of_first_;
  keeps_moments_of_first_ = false;
  before_.push_back(std::exchange(algorithm_, std::move(next)));
}

std::vector<ir::Algorithm> Builder::take() {
  // In the order of quantities.def, whatever the order asked for: what is differentiated with constraints comes last.
  std::sort(behind_.begin(), behind_.end(), [](const Behind& a, const Behind& b) { return a.quantity < b.quantity; });
  for (auto first = behind_.begin(), last = first; first != behind_.end(); first = last) {
    ir::Algorithm next;
    next.function = algorithm_.function;
    next.section = first->section;
    next.section.number = algorithm_.section.number + 1;
    for (; last != behind_.end() && last->section.name == next.section.name; ++last)
      next.section.quantities.push_back(last->quantity);
    next.arrays = algorithm_.arrays;
    next.inherited = next.arrays.size();
    end_section(std::move(next));
    std::for_each(first, last, [this](const Behind& b) { b.describe(*this); });
  }
  end_section({});
  return std::move(before_);
}

}  // namespace dalembert::passes
