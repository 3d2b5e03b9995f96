#include "frontend/urdf_reader.hpp"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <unordered_map>

#include "frontend/inertia_check.hpp"
#include "frontend/text_file.hpp"
#include "frontend/topology_check.hpp"
#include "frontend/urdf_outline.hpp"
#include "frontend/xml_document.hpp"
#include "ir/rotation.hpp"

namespace dalembert::frontend {

namespace {

// Keeps urdfdom's console messages from the user; the last one is our evidence when it refuses a file that we let pass.
class SilencedConsole : public console_bridge::OutputHandler {
 public:
  SilencedConsole() { console_bridge::useOutputHandler(this); }
  ~SilencedConsole() override { console_bridge::restorePreviousOutputHandler(); }
  SilencedConsole(const SilencedConsole&) = delete;
  SilencedConsole& operator=(const SilencedConsole&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level == console_bridge::CONSOLE_BRIDGE_LOG_ERROR) last_error = text;
  }

  std::string last_error;
};

urdf::ModelInterfaceSharedPtr parse(const std::string& file, const std::string& text) {
  SilencedConsole console;
  urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(text);
  if (!model)
    throw InputError(
        {Severity::error, file, "", "urdfdom cannot read this robot: " + console.last_error, "correct the element it names"});
  // The links own each other from the root down: released one by one, a long chain does not exhaust the stack.
  for (auto& [name, link] : model->links_) {
    link->child_links.clear();
    link->child_joints.clear();
  }
  return model;
}

Eigen::Vector3d vector(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

// `rpy` comes from the file: by way of urdfdom's quaternion the exact zeros of axis-aligned frames would be lost.
ir::Inertia inertia(const urdf::Inertial& inertial, const Eigen::Vector3d& rpy) {
  Eigen::Matrix3d about_com;
  about_com << inertial.ixx, inertial.ixy, inertial.ixz,  //
      inertial.ixy, inertial.iyy, inertial.iyz,           //
      inertial.ixz, inertial.iyz, inertial.izz;
  return {inertial.mass, vector(inertial.origin.position), ir::rotated(about_com, ir::rotation_from_rpy(rpy))};
}

ir::JointType type(const urdf::Joint& joint) {
  switch (joint.type) {
    case urdf::Joint::REVOLUTE: return ir::JointType::revolute;
    case urdf::Joint::CONTINUOUS: return ir::JointType::continuous;
    case urdf::Joint::PRISMATIC: return ir::JointType::prismatic;
    default: return ir::JointType::fixed;  // the outline refused every other type
  }
}

ir::Joint joint(const urdf::Joint& from, const Eigen::Vector3d& rpy) {
  ir::Joint joint;
  joint.name = from.name;
  joint.type = type(from);
  joint.origin.linear() = ir::rotation_from_rpy(rpy);
  joint.origin.translation() = vector(from.parent_to_joint_origin_transform.position);
  if (joint.type != ir::JointType::fixed) joint.axis = vector(from.axis).normalized();
  if (from.dynamics) {
    joint.damping = from.dynamics->damping;
    joint.friction = from.dynamics->friction;
  }
  if (from.mimic) joint.mimic = ir::Mimic{from.mimic->joint_name, from.mimic->multiplier, from.mimic->offset};
  return joint;
}

}  // namespace

ir::RobotDescription read_urdf(const std::string& path, Diagnostics& warnings) {
  return read_urdf_text(path, read_text_file(path, "URDF", xml_bytes), warnings);
}

ir::RobotDescription read_urdf_text(const std::string& file, const std::string& text, Diagnostics& warnings) {
  const UrdfOutline outline = read_outline(file, text, warnings);
  check_topology(file, outline);
  check_names(file, outline);
  const urdf::ModelInterfaceSharedPtr model = parse(file, outline.reduced);

  ir::RobotDescription robot;
  robot.file = file;
  robot.name = outline.robot;
  std::unordered_map<std::string, int> index;
  Diagnostics errors;
  for (const LinkOutline& from : outline.links) {
    ir::Link link{from.name, std::nullopt};
    if (const urdf::InertialSharedPtr inertial = model->links_.at(from.name)->inertial) {
      link.inertia = inertia(*inertial, from.inertial_rpy);
      check_inertia(file, place(from), *link.inertia, errors, warnings);
      if (link.inertia->mass == 0 && link.inertia->inertia.isZero(0)) link.inertia.reset();  // a frame
    }
    index.emplace(link.name, static_cast<int>(robot.links.size()));
    robot.links.push_back(std::move(link));
  }
  if (!errors.empty()) throw InputError(errors);

  std::unordered_map<std::string, Eigen::Vector3d> rpy;
  for (const JointOutline& from : outline.joints) rpy.emplace(from.name, from.origin_rpy);
  robot.children.resize(robot.links.size());
  std::vector<bool> is_child(robot.links.size(), false);
  for (const auto& [name, from] : model->joints_) {  // a sorted map: alphabetical
    ir::Joint joint = frontend::joint(*from, rpy.at(name));
    joint.parent = index.at(from->parent_link_name);
    joint.child = index.at(from->child_link_name);
    robot.children[static_cast<size_t>(joint.parent)].push_back(static_cast<int>(robot.joints.size()));
    is_child[static_cast<size_t>(joint.child)] = true;
    robot.joints.push_back(std::move(joint));
  }
  robot.root = static_cast<int>(std::find(is_child.begin(), is_child.end(), false) - is_child.begin());
  return robot;
}

}  // namespace dalembert::frontend
