#include "commands/report/mujoco_model.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "backend/templates.hpp"

namespace dalembert::reporting {
namespace {

using Matrix3l = Eigen::Matrix<long double, 3, 3>;

std::string numbers(const Eigen::Vector3d& v, const char* between) {
  return fmt::format("{1}{0}{2}{0}{3}", between, v.x(), v.y(), v.z());
}

// In long double, so that it costs no digits.
std::string quaternion(const Matrix3l& rotation, const char* between) {
  const Eigen::Quaterniond q = Eigen::Quaternion<long double>(rotation).normalized().cast<double>();
  return fmt::format("{1}{0}{2}{0}{3}{0}{4}", between, q.w(), q.x(), q.y(), q.z());
}

// Neither central nor along the body's axes: MuJoCo leaves out what such a body does not need.
constexpr const char* placeholder =
    "<inertial pos=\"0.1 0.2 0.3\" quat=\"0.5 0.1 0.7 0.5\" mass=\"1\" diaginertia=\"1 1.1 1.2\"/>";

std::string opening(const ir::Body& body) {
  return fmt::format(
      "<body pos=\"{}\" quat=\"{}\">{}<joint type=\"{}\" axis=\"{}\" armature=\"{}\" damping=\"{}\" stiffness=\"{}\" "
      "springref=\"{}\"/>\n",
      numbers(body.placement.translation(), " "), quaternion(body.placement.linear().cast<long double>(), " "), placeholder,
      body.turns() ? "hinge" : "slide", numbers(body.axis, " "), body.armature, body.damping, body.spring.k, body.spring.rest);
}

// MuJoCo would find principal axes to 1e-8 only.
std::string row_of(const ir::Inertia& inertia) {
  const Eigen::SelfAdjointEigenSolver<Matrix3l> solver(inertia.inertia.cast<long double>());
  Matrix3l axes = solver.eigenvectors();
  if (axes.determinant() < 0) axes.col(2) = -axes.col(2);
  return fmt::format("    {{{}, {{{}}}, {{{}}}, {{{}}}}},\n", inertia.mass, numbers(inertia.com, ", "),
                     numbers(solver.eigenvalues().cast<double>(), ", "), quaternion(axes, ", "));
}

}  // namespace

std::string mujoco_model(const ir::KinematicTree& tree, const ir::Scene& scene) {
  std::string text = fmt::format("<mujoco>\n<compiler angle=\"radian\"/>\n<option gravity=\"{}\"/>\n<worldbody>\n",
                                 numbers(scene.gravity, " "));
  if (tree.base_coordinates() > 0) text += fmt::format("<body>{}<freejoint/>\n", placeholder);
  std::vector<int> open;  // the bodies that the next may stand in
  for (size_t k = 0; k < tree.bodies.size(); ++k) {
    for (; !open.empty() && open.back() != tree.bodies[k].parent; open.pop_back()) text += "</body>\n";
    text += opening(tree.bodies[k]);
    open.push_back(static_cast<int>(k));
  }
  for (size_t i = 0; i < open.size(); ++i) text += "</body>\n";
  if (tree.base_coordinates() > 0) text += "</body>\n";
  return text + "</worldbody>\n</mujoco>\n";
}

backend::OutputFile mujoco_source(const ir::KinematicTree& tree) {
  const auto any = [&](const auto& is) { return std::any_of(tree.bodies.begin(), tree.bodies.end(), is) ? "true" : "false"; };
  std::string inertias = tree.base_coordinates() > 0 ? row_of(tree.base) : "";
  for (const ir::Body& body : tree.bodies) inertias += row_of(body.inertia);
  return {"mujoco.cpp",
          backend::render("mujoco.cpp", {{"inertias", inertias},
                                         {"armature", any([](const ir::Body& b) { return b.armature != 0; })},
                                         {"passive", any([](const ir::Body& b) { return b.damping != 0 || b.spring.k != 0; })},
                                         {"nq", std::to_string(tree.nq())},
                                         {"nv", std::to_string(tree.nv())}})};
}

}  // namespace dalembert::reporting
