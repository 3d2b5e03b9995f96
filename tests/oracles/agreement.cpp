#include "agreement.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <dalembert/generic/dynamics.hpp>
#include <dalembert/generic/frames.hpp>
#include <dalembert/generic/whole_robot.hpp>
#include <limits>
#include <memory>
#include <stdexcept>

#include "generated_robot.hpp"
#include "load_robot.hpp"
#include "long_tests.hpp"
#include "reference/generic_model.hpp"
#include "reference/instances.hpp"

namespace dalembert::oracle {
namespace {

// Largest difference over max(largest element of the reference, floor).
double relative_error(const Eigen::MatrixXd& ours, const Eigen::MatrixXd& reference, double floor) {
  if (ours.size() != reference.size()) return std::numeric_limits<double>::infinity();  // no inverse
  if (!ours.allFinite() || !reference.allFinite()) return std::numeric_limits<double>::infinity();
  const double scale = std::max(reference.cwiseAbs().maxCoeff(), floor);
  const double difference = (ours - reference).cwiseAbs().maxCoeff();
  return difference == 0 ? 0 : difference / scale;
}

Dynamics in_oracle_terms(const generic::Dynamics<double>& result, const Eigen::VectorXd& v, bool floating_base) {
  Dynamics ours;
  ours.mass_matrix = result.mass_matrix;
  ours.coriolis = result.coriolis_matrix * v;
  ours.gravity = result.gravity;
  ours.bias = result.bias;
  ours.momentum.setZero();
  if (floating_base) ours.momentum = result.mass_matrix.topRows<6>() * v;
  return ours;
}

}  // namespace

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (const TestRobot& robot : test_robots) {
    for (const Base base : {Base::floating, Base::fixed}) cases.push_back({robot, base});
  }
  return cases;
}

std::string name_of(const Case& c) { return std::string(c.robot.name) + (c.base == Base::floating ? "_floating" : "_fixed"); }

ir::KinematicTree tree_of(const Case& c) { return testing::load_robot(c.robot, c.base == Base::floating); }

Request request_of(const Case& c, const ir::KinematicTree& tree, const Eigen::Vector3d& gravity) {
  Request request{c.robot.urdf, c.base, {}, gravity};
  for (const ir::Body& body : tree.bodies) request.joints.push_back(body.joint);
  return request;
}

Engine generic_engine(const ir::KinematicTree& tree, const Eigen::Vector3d& gravity) {
  return [model = to_generic<double>(tree, gravity)](const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
    return in_oracle_terms(generic::evaluate<double>(model, q, v), v, model.floating_base);
  };
}

bool code_is_expected(const Case& c) {
  const auto& cases = testing::generated_cases();
  return long_tests() || std::any_of(cases.begin(), cases.end(), [&](const auto& each) { return each.name == name_of(c); });
}

Engine generated_engine(const Case& c) {
  for (const testing::GeneratedCase& generated : testing::generated_cases()) {
    if (generated.name != name_of(c)) continue;
    const std::shared_ptr<testing::GeneratedRobot> robot = generated.make();
    return [robot, floating = c.base == Base::floating](const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
      robot->set_state(q, v);
      robot->evaluate(testing::Variant::serial);
      const testing::Results results = robot->results(testing::Variant::serial);
      const auto of = [&](const char* name) { return results.at(name); };
      return in_oracle_terms({of("mass_matrix"), of("coriolis_matrix"), of("gravity"), of("bias"), of("wrench_influence")}, v,
                             floating);
    };
  }
  throw std::invalid_argument("no code was generated for '" + name_of(c) + "'");
}

std::vector<Error> compare(const Dynamics& ours, const Dynamics& oracle, const Eigen::Vector3d& gravity,
                           const Eigen::VectorXd& v) {
  const double inertia = 1e-3 * oracle.mass_matrix.cwiseAbs().maxCoeff();
  const double coriolis = inertia * v.squaredNorm(), weight = inertia * gravity.norm();
  return {{"M", relative_error(ours.mass_matrix, oracle.mass_matrix, 0)},
          {"C v", relative_error(ours.coriolis, oracle.coriolis, coriolis)},
          {"g", relative_error(ours.gravity, oracle.gravity, weight)},
          {"bias", relative_error(ours.bias, oracle.bias, coriolis + weight)},
          {"momentum", relative_error(ours.momentum, oracle.momentum, inertia * v.norm())}};
}

Responder generic_responder(const ir::KinematicTree& tree, const Eigen::Vector3d& gravity) {
  return [model = to_generic<double>(tree, gravity)](const Question& at) {
    const generic::Kinematics<double> kinematics = generic::phase1<double>(model, at.q, at.v);
    const Eigen::Matrix3d axes = generic::frame_pose<double>(model, kinematics, at.q, model.joints() - 1, {}).rotation;
    Eigen::VectorXd wrenches = Eigen::VectorXd::Zero(6 * model.moving_bodies());
    wrenches.tail<6>() << axes.transpose() * at.wrench.head<3>(), axes.transpose() * at.wrench.tail<3>();
    return Response{generic::inverse_dynamics<double>(model, at.q, at.v, at.v_dot, wrenches),
                    generic::forward_dynamics<double>(model, at.q, at.v, at.tau, wrenches).value,
                    generic::inverse_mass_matrix<double>(model, at.q).value};
  };
}

WholeRobot generic_whole_robot(const ir::KinematicTree& tree, const Eigen::Vector3d& gravity, const Eigen::VectorXd& q,
                               const Eigen::VectorXd& v) {
  const generic::Model<double> model = to_generic<double>(tree, gravity);
  const generic::WholeRobot<double> whole = generic::whole_robot<double>(model, q, v);
  const int last = model.joints() - 1;
  const generic::Kinematics<double> kinematics = generic::phase1<double>(model, q, v);
  const Transform<double> pose = generic::frame_pose<double>(model, kinematics, q, last, {});
  WholeRobot result{whole.kinetic_energy,
                    whole.potential_energy,
                    whole.center_of_mass,
                    whole.center_of_mass_jacobian,
                    whole.momentum_matrix * v,
                    {},
                    {}};
  result.link_pose << pose.rotation, pose.translation;
  result.link_jacobian = generic::expanded_frame_jacobian<double>(model, kinematics, q, last, {}, generic::Axes::mixed);
  return result;
}

Question question_at(const testing::State& state, std::uint64_t seed) {
  testing::Random random(seed);
  Question result{state.q, state.v, state.v, state.v, {}};
  for (Eigen::VectorXd* vector : {&result.v_dot, &result.tau})
    for (double& x : *vector) x = random.uniform(-2, 2);
  for (double& x : result.wrench) x = random.uniform(-2, 2);
  return result;
}

std::vector<Error> compare(const Response& ours, const Response& oracle) {
  return {{"inverse dynamics", relative_error(ours.inverse_dynamics, oracle.inverse_dynamics, 0)},
          {"forward dynamics", relative_error(ours.forward_dynamics, oracle.forward_dynamics, 0)},
          {"inverse of M", relative_error(ours.inverse_mass_matrix, oracle.inverse_mass_matrix, 0)}};
}

std::vector<Error> compare(const WholeRobot& ours, const WholeRobot& oracle) {
  const auto one = [](double x) { return Eigen::MatrixXd(Eigen::MatrixXd::Constant(1, 1, x)); };
  return {{"kinetic energy", relative_error(one(ours.kinetic_energy), one(oracle.kinetic_energy), 0)},
          {"potential energy", relative_error(one(ours.potential_energy), one(oracle.potential_energy), 0)},
          {"centre of mass", relative_error(ours.center_of_mass, oracle.center_of_mass, 0)},
          {"its Jacobian", relative_error(ours.center_of_mass_jacobian, oracle.center_of_mass_jacobian, 0)},
          {"momentum about it", relative_error(ours.momentum, oracle.momentum, 0)},
          {"a link's pose", relative_error(ours.link_pose, oracle.link_pose, 0)},
          {"a link's Jacobian", relative_error(ours.link_jacobian, oracle.link_jacobian, 0)}};
}

double error_in(const std::vector<Error>& errors, const std::string& quantity) {
  for (const Error& error : errors) {
    if (quantity == error.quantity) return error.value;
  }
  throw std::invalid_argument("no quantity '" + quantity + "'");
}

Case mutated_case(Base base) {
  for (const TestRobot& robot : test_robots) {
    if (std::string(robot.name) == mutated_robot) return {robot, base};
  }
  throw std::invalid_argument(std::string("no test robot '") + mutated_robot + "'");
}

std::vector<Mutation> mutations(Base base) {
  std::vector<Mutation> result{{"a mass larger by 1e-6",
                                [](ir::KinematicTree& t) { t.bodies.back().inertia.mass *= 1 + 1e-6; },
                                {"M", "C v", "g", "bias", "inverse dynamics", "forward dynamics", "inverse of M"}},
                               {"an inertia larger by 1e-6",
                                [](ir::KinematicTree& t) { t.bodies.back().inertia.inertia *= 1 + 1e-6; },
                                {"M", "C v", "bias", "inverse dynamics", "forward dynamics", "inverse of M"}},
                               {"a product of inertia of the other sign",
                                [](ir::KinematicTree& t) {
                                  auto& inertia = t.bodies.back().inertia.inertia;
                                  inertia(0, 1) = inertia(1, 0) = -inertia(0, 1);
                                },
                                {"M", "C v", "bias", "inverse dynamics", "forward dynamics", "inverse of M"}},
                               {"a centre of mass off by a micrometre",
                                [](ir::KinematicTree& t) { t.bodies.back().inertia.com[1] += 1e-6; },
                                {"M", "g", "inverse dynamics", "forward dynamics", "inverse of M"}},
                               {"a joint off by a micrometre",
                                [](ir::KinematicTree& t) { t.bodies.back().placement.translation()[0] += 1e-6; },
                                {"M", "bias", "inverse dynamics", "forward dynamics", "inverse of M"}},
                               {"an axis reversed",
                                [](ir::KinematicTree& t) { t.bodies.back().axis *= -1; },
                                {"M", "C v", "g", "bias", "inverse dynamics", "forward dynamics", "inverse of M"}},
                               {"a body on the wrong parent",
                                [](ir::KinematicTree& t) { t.bodies.back().parent = t.bodies[t.bodies.size() - 2].parent; },
                                {"M", "C v", "bias", "inverse dynamics", "forward dynamics", "inverse of M"}}};
  if (base == Base::floating) {
    result.push_back({"a base heavier by 1e-6",
                      [](ir::KinematicTree& t) { t.base.mass *= 1 + 1e-6; },
                      {"M", "g", "bias", "momentum", "inverse dynamics", "forward dynamics", "inverse of M"}});
  }
  return result;
}

Dynamics in_world_axes(const Dynamics& ours, const Eigen::VectorXd& q) {
  const Eigen::Matrix3d rotation = Eigen::Quaterniond(q[6], q[3], q[4], q[5]).toRotationMatrix();
  Dynamics result = ours;
  result.mass_matrix.topRows<3>() = rotation * ours.mass_matrix.topRows<3>();
  result.mass_matrix.leftCols<3>() = (result.mass_matrix.leftCols<3>() * rotation.transpose()).eval();
  for (Eigen::VectorXd* vector : {&result.coriolis, &result.gravity, &result.bias}) {
    vector->head<3>() = (rotation * vector->head<3>()).eval();
  }
  result.momentum.head<3>() = rotation * ours.momentum.head<3>();
  return result;
}

}  // namespace dalembert::oracle
