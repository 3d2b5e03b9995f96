// Robots with the kinds of joints that URDF's files cannot say or other tests do not have: at the base, behind and before
// joints of one axis, at a branching, and behind one another.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "ir/robot_description.hpp"
#include "ir/rotation.hpp"
#include "ir/scene.hpp"

namespace dalembert {

struct KindsRobot {
  ir::RobotDescription robot;
  std::map<std::string, ir::JointKind> joints;  // of the scene
};

inline std::vector<std::string> joint_kind_robots() {
  return {"helical", "universal", "planar", "spherical", "floating", "mixed"};
}

// K: the kind, R: revolute, P: prismatic. mixed: every K another.
//
//   base -R- l1 -K- l2 -R- l3 -K- l4 -P- l5 -R- l6
//                    `-P- l7 -K- l8
//        -K- l9 -K- l10 -R- l11
inline KindsRobot joint_kinds_robot(const std::string& kind) {
  struct Row {
    const char type;
    int parent;
  };
  const std::vector<Row> rows = {{'R', 0}, {'K', 1}, {'R', 2}, {'K', 3}, {'P', 4}, {'R', 5},
                                 {'P', 2}, {'K', 7}, {'K', 0}, {'K', 9}, {'R', 10}};
  const std::map<std::string, ir::JointType> types = {{"helical", ir::JointType::helical},
                                                      {"universal", ir::JointType::universal},
                                                      {"planar", ir::JointType::planar},
                                                      {"spherical", ir::JointType::spherical},
                                                      {"floating", ir::JointType::floating}};
  const std::vector<std::string> mixed = {"spherical", "helical", "floating", "universal", "planar"};
  KindsRobot made;
  ir::RobotDescription& robot = made.robot;
  robot.name = robot.file = kind;
  robot.root = 0;
  robot.children.resize(rows.size() + 1);
  const auto wave = [](double x) { return std::sin(37.1 * x + 0.3) * std::cos(11.7 * x); };
  for (std::size_t i = 0; i <= rows.size(); ++i) {
    const double x = static_cast<double>(i);
    const Eigen::Vector3d central(0.02 + 0.01 * wave(x), 0.03 + 0.01 * wave(x + 1), 0.025 + 0.01 * wave(x + 2));
    const Eigen::Matrix3d axes = ir::rotation_from_rpy({wave(x + 3), 0.7 * wave(x + 4), wave(x + 5)});
    ir::Link link;
    link.name = "l" + std::to_string(i);
    link.inertia = ir::Inertia{
        1.5 + wave(x + 6), {0.1 * wave(x + 7), 0.2 * wave(x + 8), 0.1 * wave(x + 9)}, ir::rotated(central.asDiagonal(), axes)};
    robot.links.push_back(link);
  }
  std::size_t which = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double x = 20 + static_cast<double>(i);
    ir::Joint joint;
    joint.name = "j" + std::to_string(i + 1);
    joint.parent = rows[i].parent;
    joint.child = static_cast<int>(i) + 1;
    joint.origin.linear() = i % 3 == 0 ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                                       : ir::rotation_from_rpy({wave(x), i % 3 == 1 ? 0 : wave(x + 1), wave(x + 2)});
    joint.origin.translation() << 0.3 * wave(x + 3), 0.3 * wave(x + 4), i % 2 ? 0.2 : 0.0;
    joint.axis = i % 2 ? Eigen::Vector3d(Eigen::Vector3d::UnitZ()) : Eigen::Vector3d(wave(x + 5), 1, wave(x + 6)).normalized();
    joint.type = rows[i].type == 'P' ? ir::JointType::prismatic : ir::JointType::revolute;
    if (rows[i].type == 'K') {
      const std::string& name = kind == "mixed" ? mixed[which++ % mixed.size()] : kind;
      ir::JointKind& as = made.joints[joint.name];
      as.type = types.at(name);
      as.pitch = name == "helical" ? 0.8 - 0.1 * x : 0;
      if (name == "universal") as.second = i % 2 ? Eigen::Vector3d(0, 1, 0) : Eigen::Vector3d(1, 0.2, wave(x + 7)).normalized();
    }
    robot.children[static_cast<std::size_t>(joint.parent)].push_back(static_cast<int>(robot.joints.size()));
    robot.joints.push_back(joint);
  }
  return made;
}

}  // namespace dalembert
