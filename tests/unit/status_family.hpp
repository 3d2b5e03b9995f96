// Robots at a known distance from a singular M: joints whose axes nearly are one another's, or nearly depend on one another,
// move one light end. What a status must tell apart.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "ir/kinematic_tree.hpp"

namespace dalembert::status_family {

// One shape of robots; at `distance` 0 M is singular.
struct Shape {
  std::string name;
  int joints = 2;         // that nearly depend on one another
  bool point = false;     // they move a point mass, not a body
  bool rows = false;      // each axis is nearly the direction that is new in the one before it, instead of nearly one axis
  bool slides = false;    // prismatic
  bool floating = false;  // all stand on a light floating base
  int before = 0;         // ordinary joints between the base and them
  int behind = 0;         // ordinary joints on the end
  double length = 1;      // of the robot, m
  double mass = 1;        // kg
  double between = 0;     // mass of what stands between the joints, of the end's
};

inline std::vector<Shape> shapes() {
  std::vector<Shape> all;
  for (const int joints : {2, 3, 4, 5, 6, 7}) all.push_back({"parallel_" + std::to_string(joints), joints});
  all.push_back({"point_2", 2, true});
  all.push_back({"point_3", 3, true});
  for (const int joints : {3, 4, 5, 6}) all.push_back({"rows_" + std::to_string(joints), joints, false, true});
  all.push_back({"slides_2", 2, false, false, true});
  all.push_back({"slides_3", 3, false, false, true});
  all.push_back({"floating_2", 2, false, false, false, true});
  all.push_back({"floating_3", 3, false, false, false, true, 1, 1});
  all.push_back({"arm_2", 2, false, false, false, false, 5, 0});
  all.push_back({"arm_3", 3, false, false, false, false, 5, 2});
  all.push_back({"chain_3", 3, false, false, false, false, 24, 0});
  all.push_back({"chain_2", 2, false, false, false, false, 8, 16});
  all.push_back({"millimetres_3", 3, false, false, false, false, 2, 1, 1e-3, 1e-6});
  all.push_back({"tons_3", 3, false, false, false, false, 2, 1, 10, 1e4});
  all.push_back({"light_3", 3, false, false, false, false, 2, 1, 1, 1, 1e-9});
  return all;
}

// The robot of a shape at a distance: 1 is an ordinary robot. seed: of its other numbers.
inline ir::KinematicTree robot(const Shape& shape, double distance, unsigned seed) {
  std::mt19937 engine(seed);
  const auto uniform = [&] { return static_cast<double>(engine()) * 0x1p-31 - 1; };
  const auto direction = [&] {
    Eigen::Vector3d x(uniform(), uniform(), uniform());
    return Eigen::Vector3d(x.normalized());
  };
  const auto body = [&](double mass) -> ir::Inertia {
    const double l = shape.length;
    return {mass, l * Eigen::Vector3d(0.1 * uniform(), 0.1 * uniform(), 0.2 + 0.1 * uniform()),
            mass * l * l * Eigen::Vector3d(0.02, 0.025, 0.01).asDiagonal()};
  };
  ir::KinematicTree tree;
  tree.robot = shape.name;
  tree.base_link = "base";
  if (shape.floating) tree.base_joint = ir::JointType::floating;
  if (shape.floating) tree.base = body(1e-2 * shape.mass);
  tree.links = {{"base", -1}};
  const auto add = [&](const Eigen::Vector3d& axis, const Eigen::Vector3d& at, const ir::Inertia& inertia, bool slides) {
    ir::Body b;
    b.name = "l" + std::to_string(tree.bodies.size());
    b.joint = "j" + std::to_string(tree.bodies.size());
    b.parent = tree.joints() - 1;
    b.axis = axis.normalized();
    b.placement.translation() = at;
    b.inertia = inertia;
    b.type = slides ? ir::JointType::prismatic : ir::JointType::revolute;
    tree.links.push_back({b.name, tree.joints()});
    tree.bodies.push_back(b);
  };
  const Eigen::Vector3d along(0, 0, 0.4 * shape.length);
  for (int k = 0; k < shape.before; ++k) add(direction(), along, body(shape.mass), false);
  Eigen::Vector3d axis = direction(), at = along, last = axis;
  for (int k = 0; k < shape.joints; ++k) {
    const bool end = k == shape.joints - 1;
    ir::Inertia inertia = end ? body(shape.mass) : body(shape.between * shape.mass);
    if (end && shape.point) inertia.inertia.setZero();
    if (!end && shape.between == 0) inertia = {};
    add(axis, at, inertia, shape.slides);
    const Eigen::Vector3d own = direction();
    axis = shape.rows ? Eigen::Vector3d(last + distance * own) : Eigen::Vector3d(last.normalized() + distance * own);
    if (shape.rows) last = own;
    at = shape.slides ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                      : Eigen::Vector3d(distance * shape.length * Eigen::Vector3d(uniform(), uniform(), uniform()));
  }
  for (int k = 0; k < shape.behind; ++k) add(direction(), along, body(shape.mass), false);
  for (std::size_t k = 0; k < tree.bodies.size(); ++k) tree.bodies[k].subtree_size = tree.joints() - static_cast<int>(k);
  return tree;
}

}  // namespace dalembert::status_family
