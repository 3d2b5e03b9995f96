#include "commands/report/pinocchio.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <new>
#include <stdexcept>

namespace dalembert::reporting {
namespace {

using enum ir::Quantity;

std::vector<std::string> words(std::string_view text) {
  std::vector<std::string> list;
  while (!text.empty()) {
    const size_t blank = std::min(text.find(' '), text.size());
    list.emplace_back(text.substr(0, blank));
    text.remove_prefix(std::min(blank + 1, text.size()));
  }
  return list;
}

template <class Matrix>
void copy_row_by_row(const Matrix& matrix, double* to) {
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    for (Eigen::Index k = 0; k < matrix.cols(); ++k) *to++ = matrix(i, k);
}

dalembert_pinocchio_body inertial(const ir::Inertia& inertia) {
  dalembert_pinocchio_body body{};
  body.mass = inertia.mass;
  copy_row_by_row(inertia.com, body.com);
  copy_row_by_row(inertia.inertia, body.inertia);
  return body;
}

dalembert_pinocchio_body body_of(const ir::Body& from) {
  dalembert_pinocchio_body body = inertial(from.inertia);
  body.parent = from.parent;
  body.slides = !from.turns();
  body.armature = from.armature;
  copy_row_by_row(from.axis, body.axis);
  copy_row_by_row(from.placement.linear(), body.rotation);
  copy_row_by_row(from.placement.translation(), body.translation);
  return body;
}

}  // namespace

std::string pinocchio_library() {
  if (const char* given = std::getenv("DALEMBERT_PINOCCHIO")) return given;
  std::error_code error;
  return (std::filesystem::read_symlink("/proc/self/exe", error).parent_path().parent_path() / "lib" /
          "libdalembert_pinocchio.so")
      .string();
}

template <class Function>
Function* PinocchioRobot::function(const char* name) const {
  void* const address = dlsym(library_.get(), name);
  if (!address) throw std::runtime_error(std::string("Pinocchio's library has no ") + name);
  return reinterpret_cast<Function*>(address);
}

PinocchioRobot::PinocchioRobot(const ir::KinematicTree& tree, const Eigen::Vector3d& gravity) {
  library_ = {dlopen(pinocchio_library().c_str(), RTLD_NOW | RTLD_LOCAL), [](void* library) {
                if (library) dlclose(library);
              }};
  if (!library_) throw std::runtime_error(dlerror());
  int count = 0;
  const Call* const calls = function<decltype(dalembert_pinocchio_calls)>("dalembert_pinocchio_calls")(&count);
  calls_.assign(calls, calls + count);
  std::vector<dalembert_pinocchio_body> bodies;
  for (const ir::Body& body : tree.bodies) bodies.push_back(body_of(body));
  const dalembert_pinocchio_body base = inertial(tree.base);
  const auto destroy = function<decltype(dalembert_pinocchio_destroy)>("dalembert_pinocchio_destroy");
  robot_ = {function<decltype(dalembert_pinocchio_create)>("dalembert_pinocchio_create")(
                tree.base_coordinates() > 0, &base, bodies.data(), static_cast<int>(bodies.size()), gravity.data()),
            [library = library_, destroy](dalembert_pinocchio_robot* robot) {
              if (robot) destroy(robot);
            }};
  if (!robot_) throw std::bad_alloc();
}

std::string PinocchioRobot::version() const {
  return function<decltype(dalembert_pinocchio_version)>("dalembert_pinocchio_version")();
}
std::string PinocchioRobot::compiled() const {
  return function<decltype(dalembert_pinocchio_compiled)>("dalembert_pinocchio_compiled")();
}

const PinocchioRobot::Call* PinocchioRobot::call(const std::vector<ir::Quantity>& quantities) const {
  std::vector<std::string> wanted;
  for (const ir::Quantity quantity : quantities) wanted.emplace_back(ir::name_of(quantity));
  for (const Call& call : calls_) {
    const std::vector<std::string> offered = words(call.quantities);
    if (wanted.size() == offered.size() && std::is_permutation(wanted.begin(), wanted.end(), offered.begin())) return &call;
  }
  for (const Call& call : calls_) {
    const std::vector<std::string> offered = words(call.quantities);
    if (wanted.size() == 1 && std::find(offered.begin(), offered.end(), wanted.front()) != offered.end()) return &call;
  }
  return nullptr;
}

Eigen::MatrixXd PinocchioRobot::result(const Call& call, ir::Quantity quantity, int rows, int columns) const {
  const std::vector<std::string> offered = words(call.quantities);
  const auto which = std::find(offered.begin(), offered.end(), ir::name_of(quantity)) - offered.begin();
  const dalembert_pinocchio_result result = call.result(robot_.get(), static_cast<int>(which));
  Eigen::MatrixXd matrix(rows, columns);
  for (int i = 0; i < rows; ++i)
    for (int k = 0; k < columns; ++k) {
      // Pinocchio's inertial parameters end in xx, xy, yy, xz, yz, zz.
      const int inside = k % 10, at = quantity != regressor || inside < 6 || inside > 7 ? k : inside == 6 ? k + 1 : k - 1;
      matrix(i, k) = result.values[i * result.row_step + at * result.column_step];
    }
  return matrix;
}

Pinocchio::Pinocchio(const Model& model) : model_(model) {
  if (std::any_of(model.tree.bodies.begin(), model.tree.bodies.end(), [](const ir::Body& b) { return b.driven(); })) {
    // The library is looked for all the same, to be named.
    model_.tree.bodies.clear();
  }
  try {
    robot_ = std::make_unique<PinocchioRobot>(model_.tree, model.scene.gravity);
  } catch (const std::runtime_error&) {
    robot_ = nullptr;  // nothing is missing without it
  }
  model_.tree = model.tree;
}

const PinocchioRobot::Call* Pinocchio::call(const Output& output) const {
  if (!output.quantity) return nullptr;
  return robot_->call({*output.quantity});
}

std::string Pinocchio::obstacle(const Output& output) const {
  const auto any = [&](bool (*is)(const ir::Body&)) {
    return std::any_of(model_.tree.bodies.begin(), model_.tree.bodies.end(), is);
  };
  if (any([](const ir::Body& b) { return b.driven(); }))
    return "there are mimic joints, which the report does not make for Pinocchio";
  if (!model_.scene.payloads.empty()) return "payloads are given at run time, which Pinocchio's model has none of";
  if (!call(output)) return "the report asks Pinocchio for no such quantity";
  if (output.part) return "a part of it is asked for, and Pinocchio computes the whole";
  const ir::EmittedFunction& computed_by = output.function;
  if (computed_by.named && computed_by.quantities.size() + computed_by.of_links.size() > 1)
    return "one call computes this and more, none of Pinocchio's does";
  const ir::Quantity quantity = *output.quantity;
  if (quantity == coriolis_matrix && model_.scene.coriolis != ir::Coriolis::christoffel)
    return "Pinocchio's C is of Christoffel symbols: compare it with coriolis: christoffel";
  const bool of_motion = ir::row_of(quantity).function != ir::Function::evaluate && quantity != regressor;
  if (of_motion && !model_.scene.wrenches.empty())
    return "there are external forces given at run time, which these functions of Pinocchio's do not take";
  if ((of_motion || is_any_of(quantity, {bias, potential_energy})) &&
      any([](const ir::Body& b) { return b.friction != 0 || b.damping != 0 || b.spring.k != 0; }))
    return "Pinocchio's functions know neither springs nor dampers nor friction";
  // Of 3.7: JointModelRevoluteUnaligned keeps no joint_v, which computeKineticEnergy multiplies the armature by.
  if (quantity == kinetic_energy &&
      any([](const ir::Body& b) { return b.armature != 0 && b.turns() && (b.axis.array() == 1).count() == 0; }))
    return "Pinocchio's kinetic energy lacks the armature of revolute joints about oblique axes";
  return "";
}

// Of statics, and of gravity, at rest.
State Pinocchio::input_of(const Output& output, const State& state) const {
  State input = state;
  if (model_.scene.rates_zero) input.v.setZero();
  if (output.function.input()[0] == 0) input.more = Eigen::VectorXd::Zero(input.v.size());
  return input;
}

Eigen::MatrixXd Pinocchio::result(const Output& output, const State& state) const {
  const State input = input_of(output, state);
  const PinocchioRobot::Call& call = *this->call(output);
  robot_->run(call, input.q.data(), input.v.data(), input.more.data());
  return robot_->result(call, *output.quantity, output.rows, output.columns);
}

CallTime Pinocchio::time_per_call(const Output& output, const std::vector<State>& states) const {
  std::vector<State> inputs;
  for (const State& state : states) inputs.push_back(input_of(output, state));
  const PinocchioRobot::Call& call = *this->call(output);
  return time_calls(inputs.size(),
                    [&](size_t s) { robot_->run(call, inputs[s].q.data(), inputs[s].v.data(), inputs[s].more.data()); });
}

}  // namespace dalembert::reporting
