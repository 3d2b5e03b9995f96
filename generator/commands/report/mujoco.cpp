#include "commands/report/mujoco.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <stdexcept>

#include "backend/output_files.hpp"
#include "commands/report/mujoco_model.hpp"
#include "commands/temporary_folder.hpp"

namespace dalembert::reporting {
namespace {

using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Vector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;
using Vector3 = Eigen::Matrix<long double, 3, 1>;

std::string name_of(const char* function) { return std::string("dalembert_mujoco_") + function; }

bool any_body(const ir::KinematicTree& tree, bool (*is)(const ir::Body&)) {
  return std::any_of(tree.bodies.begin(), tree.bodies.end(), is);
}

// Ours; of statics, and of gravity, zero.
Vector velocity(const ir::Scene& scene, const Output& output, const State& state) {
  if (scene.rates_zero || output.quantity == ir::Quantity::gravity) return Vector::Zero(state.v.size());
  return state.v.cast<long double>();
}

}  // namespace

// From our coordinates of a state's velocity to MuJoCo's: qvel = T v and qacc = T v̇ + Ṫ v, T turning the base's linear part by
// R. In long double, so that the change costs no digits.
struct Mujoco::Turned {
  bool base_moves;
  Eigen::Matrix<long double, 3, 3> R;
  Vector drift;  // Ṫ v: R (ω × v) of the base

  Turned(bool base_moves, const Eigen::VectorXd& q, const Vector& v) : base_moves(base_moves), drift(Vector::Zero(v.size())) {
    if (!base_moves) return;
    R = Eigen::Quaternion<long double>(q[6], q[3], q[4], q[5]).normalized().toRotationMatrix();  // w x y z
    drift.head<3>() = R * Vector3(v.segment<3>(3)).cross(Vector3(v.head<3>()));
  }
  Vector there(Vector x) const {
    if (base_moves) x.head<3>() = (R * x.head<3>()).eval();
    return x;
  }
  void rows_back(Matrix& x) const {
    if (base_moves) x.topRows<3>() = (R.transpose() * x.topRows<3>()).eval();
  }
  void columns_back(Matrix& x) const {
    if (base_moves) x.leftCols<3>() = (x.leftCols<3>() * R).eval();
  }
};

Mujoco::Mujoco(const Model& model, const CompilerOptions& compiler) : model_(model) {
  try {
    load(compiler);
  } catch (const std::runtime_error& e) {
    obstacle_ = complaint(e);
  }
}

void Mujoco::load(const CompilerOptions& compiler) {
  CompilerOptions options = compiler;
  options.libraries = "-lmujoco";
  code_ = std::make_unique<LoadedCode>("mujoco", std::vector{mujoco_source(model_.tree)}, options);
  version_ = code_->function<const char*()>(name_of("version"))();

  const TemporaryFolder folder;
  backend::add_files(folder.path().string(), {{"robot.xml", mujoco_model(model_.tree, model_.scene)}});
  std::array<char, 500> message{};
  Peer* const peer = code_->function<Peer*(const char*, char*, int)>(name_of("create"))(
      (folder.path() / "robot.xml").c_str(), message.data(), static_cast<int>(message.size()));
  if (peer) peer_ = {peer, code_->function<void(Peer*)>(name_of("destroy"))};
  else obstacle_ = "MuJoCo refuses the model: " + std::string(message.data());
}

Mujoco::Quantity* Mujoco::function(ir::Quantity quantity) const {
  const std::string name = name_of(ir::row_of(quantity).name);
  return code_->has(name) ? code_->function<Quantity>(name) : nullptr;
}

std::string Mujoco::obstacle(const Output& output) const {
  using enum ir::Quantity;
  if (any_body(model_.tree, [](const ir::Body& b) { return b.driven(); }))
    return "there are mimic joints: MuJoCo has constraints for that, which its M and bias know nothing of";
  if (any_body(model_.tree, [](const ir::Body& b) { return b.is_screw(); }))
    return "there are helical joints, which MuJoCo has none of";
  if (!model_.scene.payloads.empty()) return "payloads are given at run time, which MuJoCo's model has none of";
  if (!obstacle_.empty()) return obstacle_;
  if (!output.quantity || !function(*output.quantity)) return "the report asks MuJoCo for no such quantity";
  if (output.part) return "a part of it is asked for, and MuJoCo computes the whole";
  const ir::EmittedFunction& computed_by = output.function;
  if (computed_by.named && computed_by.quantities.size() + computed_by.of_links.size() > 1)
    return "one call computes this and more, none of MuJoCo's does";
  if (is_any_of(*output.quantity, {inverse_dynamics, forward_dynamics}) && !model_.scene.wrenches.empty())
    return "there are external forces given at run time, which MuJoCo's functions of this do not take";
  if (is_any_of(*output.quantity, {bias, inverse_dynamics, forward_dynamics}) &&
      any_body(model_.tree, [](const ir::Body& b) { return b.friction != 0; }))
    return "Coulomb friction is a constraint in MuJoCo, and no part of its bias";
  return "";
}

Mujoco::Input Mujoco::input_of(const Output& output, const State& state) const {
  const Vector v = velocity(model_.scene, output, state);
  const Turned turned(model_.tree.base_coordinates() > 0, state.q, v);
  Eigen::VectorXd qpos = state.q;
  if (turned.base_moves) qpos.segment<4>(3) << state.q[6], state.q.segment<3>(3);
  Vector more = turned.there(state.more.cast<long double>());
  if (output.quantity == ir::Quantity::inverse_dynamics) more += turned.drift;
  const auto list = [](const Eigen::VectorXd& x) { return std::vector<double>(x.begin(), x.end()); };
  return {list(qpos), list(turned.there(v).cast<double>()), list(more.cast<double>())};
}

Eigen::MatrixXd Mujoco::result(const Output& output, const State& state) const {
  using enum ir::Quantity;
  const ir::Quantity quantity = *output.quantity;
  const Input input = input_of(output, state);
  const auto own = [&](ir::Quantity wanted, int rows, int columns) -> Matrix {
    const double* values = function(wanted)(peer_.get(), input.qpos.data(), input.qvel.data(), input.more.data());
    return Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(values, rows, columns)
        .cast<long double>();
  };
  const Turned turned(model_.tree.base_coordinates() > 0, state.q, velocity(model_.scene, output, state));
  Matrix value = own(quantity, output.rows, output.columns);
  if (quantity == bias && turned.base_moves) value += own(mass_matrix, model_.tree.nv(), model_.tree.nv()) * turned.drift;
  if (quantity == forward_dynamics) value -= turned.drift;
  if (is_any_of(quantity, {mass_matrix, inverse_mass_matrix, gravity, bias, inverse_dynamics, forward_dynamics}))
    turned.rows_back(value);
  if (is_any_of(quantity, {mass_matrix, inverse_mass_matrix, center_of_mass_jacobian})) turned.columns_back(value);
  return value.cast<double>();
}

CallTime Mujoco::time_per_call(const Output& output, const std::vector<State>& states) const {
  std::vector<Input> inputs;
  for (const State& state : states) inputs.push_back(input_of(output, state));
  Quantity* const compute = function(*output.quantity);
  return time_calls(inputs.size(), [&](size_t s) {
    compute(peer_.get(), inputs[s].qpos.data(), inputs[s].qvel.data(), inputs[s].more.data());
  });
}

}  // namespace dalembert::reporting
