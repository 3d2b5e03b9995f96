// Makes a model of bodies, as Pinocchio's URDF reader does: joints about coordinate axes are of their own type. The joint of a
// body that turns without end is a plain revolute one, with one number in q.
#include "robot.hpp"

#include <algorithm>
#include <chrono>
#include <new>
#include <pinocchio/multibody/joint/joint-generic.hpp>
#include <string>

#include "compiled.hpp"

namespace {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

pinocchio::JointModel joint_of(const dalembert_pinocchio_body& body) {
  const Vector3 axis(body.axis[0], body.axis[1], body.axis[2]);
  if (body.slides) {
    if (axis == Vector3::UnitX()) return pinocchio::JointModelPX();
    if (axis == Vector3::UnitY()) return pinocchio::JointModelPY();
    if (axis == Vector3::UnitZ()) return pinocchio::JointModelPZ();
    return pinocchio::JointModelPrismaticUnaligned(axis);
  }
  if (axis == Vector3::UnitX()) return pinocchio::JointModelRX();
  if (axis == Vector3::UnitY()) return pinocchio::JointModelRY();
  if (axis == Vector3::UnitZ()) return pinocchio::JointModelRZ();
  return pinocchio::JointModelRevoluteUnaligned(axis);
}

pinocchio::Inertia inertia_of(const dalembert_pinocchio_body& body) {
  return {body.mass, Eigen::Map<const Vector3>(body.com),
          pinocchio::Symmetric3(Matrix3(Eigen::Map<const Matrix3>(body.inertia)))};
}

pinocchio::Model model_of(bool floating, const dalembert_pinocchio_body* base, const dalembert_pinocchio_body* bodies,
                          int count, const double* gravity) {
  pinocchio::Model model;
  model.gravity.linear() = Eigen::Map<const Vector3>(gravity);
  pinocchio::JointIndex root = 0;
  if (floating) {
    root = model.addJoint(0, pinocchio::JointModelFreeFlyer(), pinocchio::SE3::Identity(), "base");
    model.appendBodyToJoint(root, inertia_of(*base));
  }
  for (int k = 0; k < count; ++k) {
    const dalembert_pinocchio_body& body = bodies[k];
    const pinocchio::SE3 placement(Matrix3(Eigen::Map<const Matrix3>(body.rotation)),
                                   Eigen::Map<const Vector3>(body.translation));
    const pinocchio::JointIndex parent = root + static_cast<pinocchio::JointIndex>(body.parent + 1);
    const pinocchio::JointIndex joint = model.addJoint(parent, joint_of(body), placement, "joint_" + std::to_string(k));
    model.appendBodyToJoint(joint, inertia_of(body));
    model.armature[model.idx_vs[joint]] = body.armature;
  }
  return model;
}

// The faster of the two, at some state.
void choose(dalembert_pinocchio_robot& robot, pinocchio::Convention& convention,
            void (*run)(dalembert_pinocchio_robot*, const double*, const double*, const double*)) {
  using Clock = std::chrono::steady_clock;
  Eigen::VectorXd q = Eigen::VectorXd::Constant(robot.model.nq, 0.3);
  if (robot.model.nq > robot.model.nv) q.segment<4>(3) << 0, 0, 0, 1;
  const Eigen::VectorXd v = Eigen::VectorXd::Constant(robot.model.nv, 0.7);
  double best = 0;
  pinocchio::Convention fastest = convention;
  for (const pinocchio::Convention one : {pinocchio::Convention::WORLD, pinocchio::Convention::LOCAL}) {
    convention = one;
    double least = 0;
    for (int round = 0; round < 20; ++round) {
      const Clock::time_point start = Clock::now();
      for (int i = 0; i < 20; ++i) run(&robot, q.data(), v.data(), v.data());
      const double time = std::chrono::duration<double>(Clock::now() - start).count();
      least = round == 0 ? time : std::min(least, time);
    }
    if (best == 0 || least < best) best = least, fastest = one;
  }
  convention = fastest;
}

constexpr dalembert_pinocchio_call calls[] = {
#define PINOCCHIO_ROW(name, quantities) {quantities, run_##name, result_of_##name},
    PINOCCHIO_CALLS(PINOCCHIO_ROW)
#undef PINOCCHIO_ROW
};

}  // namespace

const char* dalembert_pinocchio_version() { return PINOCCHIO_VERSION; }
const char* dalembert_pinocchio_compiled() { return DALEMBERT_PINOCCHIO_COMPILED; }
const dalembert_pinocchio_call* dalembert_pinocchio_calls(int* count) {
  *count = static_cast<int>(std::size(calls));
  return calls;
}

dalembert_pinocchio_robot* dalembert_pinocchio_create(int floating, const dalembert_pinocchio_body* base,
                                                      const dalembert_pinocchio_body* bodies, int count,
                                                      const double* gravity) {
  try {
    auto* const robot = new dalembert_pinocchio_robot(model_of(floating != 0, base, bodies, count, gravity));
    choose(*robot, robot->of_mass_matrix, run_mass_matrix);
    choose(*robot, robot->of_forward_dynamics, run_forward_dynamics);
    return robot;
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

void dalembert_pinocchio_destroy(dalembert_pinocchio_robot* robot) { delete robot; }
