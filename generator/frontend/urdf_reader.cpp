#include "frontend/urdf_reader.hpp"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <tinyxml.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <unordered_map>
#include <vector>

#include "frontend/cpp_names.hpp"
#include "frontend/floating_root.hpp"
#include "frontend/text_file.hpp"
#include "frontend/topology_check.hpp"
#include "frontend/urdf_outline.hpp"
#include "frontend/xml_document.hpp"
#include "ir/rotation.hpp"

namespace dalembert::frontend {

namespace {

// Keeps urdfdom's console messages from the user: they become diagnostics.
class SilencedConsole : public console_bridge::OutputHandler {
 public:
  SilencedConsole() { console_bridge::useOutputHandler(this); }
  ~SilencedConsole() override { console_bridge::restorePreviousOutputHandler(); }
  SilencedConsole(const SilencedConsole&) = delete;
  SilencedConsole& operator=(const SilencedConsole&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_WARN) messages.push_back(text);
  }

  std::vector<std::string> messages;
};

// The bare tree as a URDF: links, joints, and which hangs on which. No number that urdfdom could read otherwise than we did,
// and nothing it could drop.
std::string bare_tree(const UrdfOutline& outline) {
  TiXmlDocument document;
  TiXmlElement robot("robot");
  robot.SetAttribute("name", outline.robot);
  for (const LinkOutline& from : outline.links) {
    TiXmlElement link("link");
    link.SetAttribute("name", from.name);
    robot.InsertEndChild(link);
  }
  for (const JointOutline& from : outline.joints) {
    TiXmlElement joint("joint");
    joint.SetAttribute("name", from.name);
    joint.SetAttribute("type", "fixed");
    for (const auto& [tag, link] : {std::pair{"parent", &from.parent}, {"child", &from.child}}) {
      TiXmlElement end(tag);
      end.SetAttribute("link", *link);
      joint.InsertEndChild(end);
    }
    robot.InsertEndChild(joint);
  }
  document.InsertEndChild(robot);
  TiXmlPrinter printer;
  document.Accept(&printer);
  return printer.Str();
}

// urdfdom's tree of the robot. Whatever it says about it is an error or a warning.
urdf::ModelInterfaceSharedPtr parse(const std::string& file, const UrdfOutline& outline, Diagnostics& warnings) {
  SilencedConsole console;
  urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(bare_tree(outline));
  const std::string robot = fmt::format("robot '{}'", outline.robot);
  if (!model)
    throw InputError({Severity::error, file, robot,
                      "urdfdom cannot read it: " + (console.messages.empty() ? "" : console.messages.back()),
                      "correct the element it names"});
  for (const std::string& message : console.messages)
    warnings.push_back({Severity::warning, file, robot, "urdfdom says: " + message, "correct the element it names"});
  Diagnostics errors;
  const auto lost = [&](std::string element) {
    add_error(errors, {Severity::error, file, std::move(element), "urdfdom does not find it by its name",
                       "give it a name of letters, digits and '_'"});
  };
  for (const LinkOutline& link : outline.links)
    if (!model->links_.count(link.name)) lost(place(link));
  for (const JointOutline& joint : outline.joints)
    if (!model->joints_.count(joint.name)) lost(place(joint));
  if (!errors.empty()) throw InputError(errors);
  // The links own each other from the root down: released one by one, a long chain does not exhaust the stack.
  for (auto& [name, link] : model->links_) {
    link->child_links.clear();
    link->child_joints.clear();
  }
  return model;
}

Eigen::Matrix3d rotation(const Frame& frame) { return frame.rotation ? *frame.rotation : ir::rotation_from_rpy(frame.rpy); }

ir::Link link(const LinkOutline& from) {
  ir::Link link{.name = from.name, .line = from.line};
  if (from.inertial && (from.inertial->mass != 0 || !from.inertial->inertia.isZero(0)))  // a frame otherwise
    link.inertia = ir::Inertia{from.inertial->mass, from.inertial->origin.xyz,
                               ir::rotated(from.inertial->inertia, rotation(from.inertial->origin))};
  return link;
}

ir::Joint joint(const JointOutline& from) {
  ir::Joint joint;
  joint.name = from.name;
  joint.type = from.type;
  joint.origin.linear() = rotation(from.origin);
  joint.origin.translation() = from.origin.xyz;
  if (joint.type != ir::JointType::fixed) joint.axis = from.axis.stableNormalized();
  joint.axis_is_known = from.axis_is_known;
  if (joint.type == ir::JointType::universal) joint.second = from.second.stableNormalized();
  joint.pitch = from.pitch;
  joint.damping = from.damping;
  joint.friction = from.friction;
  joint.mimic = from.mimic;
  joint.limits = from.limits;
  joint.line = from.line;
  return joint;
}

}  // namespace

ir::RobotDescription read_urdf(const std::string& path, Diagnostics& warnings) {
  return read_urdf_text(path, read_text_file(path, "URDF", xml_bytes), warnings);
}

ir::RobotDescription read_urdf_text(const std::string& file, const std::string& text, Diagnostics& warnings) {
  UrdfOutline outline = read_outline(file, text, warnings);
  outline.text = text;
  return robot_of(file, std::move(outline), warnings);
}

ir::RobotDescription robot_of(const std::string& file, UrdfOutline outline, Diagnostics& warnings) {
  check_topology(file, outline);
  take_floating_root(file, outline, warnings);
  make_names_distinct(file, outline, warnings);
  const urdf::ModelInterfaceSharedPtr model = parse(file, outline, warnings);

  ir::RobotDescription robot;
  robot.file = file;
  robot.files = {file};
  robot.files.insert(robot.files.end(), outline.included.begin(), outline.included.end());
  robot.text = std::move(outline.text);
  robot.name = outline.robot;
  robot.floating_root = outline.floating_root;
  robot.loops = std::move(outline.loops);
  robot.root_pose.linear() = rotation(outline.root_pose);
  robot.root_pose.translation() = outline.root_pose.xyz;
  std::unordered_map<std::string, int> index;
  for (const LinkOutline& from : outline.links) {
    index.emplace(from.name, static_cast<int>(robot.links.size()));
    robot.links.push_back(link(from));
  }
  std::unordered_map<std::string, const JointOutline*> outlines;
  for (const JointOutline& from : outline.joints) outlines.emplace(from.name, &from);
  robot.children.resize(robot.links.size());
  std::vector<bool> is_child(robot.links.size(), false);
  for (const auto& [name, from] : model->joints_) {  // a sorted map: alphabetical
    ir::Joint joint = frontend::joint(*outlines.at(name));
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
