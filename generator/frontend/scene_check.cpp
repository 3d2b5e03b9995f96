#include "frontend/scene_check.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "frontend/nearest.hpp"
#include "frontend/scene_checks.hpp"

namespace dalembert::frontend {

SceneCheck::SceneCheck(const SceneDocument& document, const ir::RobotDescription& robot, Diagnostics& warnings)
    : document_(document), robot_(robot), warnings_(warnings), scene_(document.scene) {
  for (size_t i = 0; i < robot.links.size(); ++i) links_.emplace(robot.links[i].name, static_cast<int>(i));
  for (size_t j = 0; j < robot.joints.size(); ++j) joints_.emplace(robot.joints[j].name, static_cast<int>(j));
  is_cut_.assign(robot.links.size(), false);
}

ir::Scene SceneCheck::run() {
  if (!document_.given.count("loops")) scene_.loops = robot_.loops;
  if (!document_.given.count("base")) scene_.base = default_base(robot_);
  outputs();
  cut();
  kinds();
  locked();
  mimic();
  placed();
  links_asked("jacobians", scene_.jacobians);
  std::vector<std::string> frames;
  for (const ir::LinkOutput& output : scene_.frames)
    if (std::find(frames.begin(), frames.end(), output.link) == frames.end()) frames.push_back(output.link);
  links_asked("frames", frames);
  names_differ();
  functions();
  links_asked("payloads", scene_.payloads);
  wrenches();
  contacts();
  for (const std::string& joint : scene_.passive)
    if (free_joint("passive", joint) && scene_.mimic.count(joint))
      error("passive/" + joint, fmt::format("joint '{}' is driven by another", joint), "name the joint that drives it");
  for (const auto& [joint, value] : scene_.armature) free_joint("armature", joint);
  for (const auto& [joint, value] : scene_.damping) free_joint("damping", joint);
  for (const auto& [joint, value] : scene_.friction) free_joint("friction", joint);
  stiffness();
  elastic();
  parts();
  plan();
  rollouts();
  if (scene_.urdf_damping) urdf_values("damping", &ir::Joint::damping);
  if (scene_.urdf_friction) urdf_values("friction", &ir::Joint::friction);
  if (!errors_.empty()) throw InputError(errors_);
  say_what_base_is_taken();
  warn_of_mimic();
  say_what_loops_are_taken();
  warn_of_turned_rods();
  warn_of_losses("damping", scene_.urdf_damping, scene_.damping, &ir::Joint::damping);
  warn_of_losses("friction", scene_.urdf_friction, scene_.friction, &ir::Joint::friction);
  return std::move(scene_);
}

bool SceneCheck::moving_joint(const std::string& key, const std::string& name) {
  if (!known(key, "joint", name, joints_)) return false;
  const ir::Joint& joint = robot_.joints[static_cast<size_t>(joints_.at(name))];
  if (joint.type == ir::JointType::fixed)
    error(locate(key, name), fmt::format("joint '{}' is fixed", name), "name a joint that moves, or remove it here");
  else if (is_cut(joint))
    error(locate(key, name), fmt::format("joint '{}' is cut off", name),
          "remove it here, or remove the link it belongs to from 'cut'");
  else return true;
  return false;
}

bool SceneCheck::free_joint(const std::string& key, const std::string& name) {
  if (!moving_joint(key, name)) return false;
  if (!scene_.locked.count(name)) return true;
  error(locate(key, name), fmt::format("joint '{}' is locked", name), "remove it here, or from 'locked'");
  return false;
}

ir::JointType SceneCheck::type_of(const std::string& name) const {
  const auto kind = scene_.joints.find(name);
  return kind == scene_.joints.end() ? robot_.joints[static_cast<size_t>(joints_.at(name))].type : kind->second.type;
}

bool SceneCheck::of_one_coordinate(const std::string& key, const std::string& name) {
  if (coordinates_of(name) == 1) return true;
  error(locate(key, name), fmt::format("joint '{}' has {} coordinates", name, coordinates_of(name)),
        "name a joint of one coordinate, or remove it here");
  return false;
}

void SceneCheck::kept_link(const std::string& key, const std::string& name) {
  if (frames_.contains(name)) return;  // its link has been looked at
  if (!links_.contains(name)) {
    std::unordered_map<std::string, int> places = links_;
    places.insert(frames_.begin(), frames_.end());
    known(key, "link", name, places);
  } else if (is_cut_[static_cast<size_t>(links_.at(name))]) {
    error(locate(key, name), fmt::format("link '{}' is cut off", name),
          "remove it here, or remove the link it hangs on from 'cut'");
  }
}

bool SceneCheck::known(const std::string& key, const char* kind, const std::string& name,
                       const std::unordered_map<std::string, int>& names) {
  if (names.count(name)) return true;
  if (&names == &joints_ && !name.empty() && name == robot_.floating_root) {
    error(locate(key, name), fmt::format("joint '{}' is the floating base, and none of the joints that move on it", name),
          scene_.base == ir::Base::floating ? "remove it here; base: fixed welds its link to the world" : "remove it here");
    return false;
  }
  for (const auto& [joint, elasticity] : scene_.elastic)
    if (name == joint + "_spring" || name == joint + "_motor") {
      error(locate(key, name), fmt::format("'{}' is a part of elastic joint '{}'", name, joint),
            fmt::format("what belongs to it stands under elastic, and what belongs to the motor under '{}'", joint));
      return false;
    }
  std::vector<std::string> all;
  for (const auto& entry : names) all.push_back(entry.first);
  std::sort(all.begin(), all.end());
  error(locate(key, name), fmt::format("there is no {} '{}'", kind, name), other_kind(name, suggestion(name, all)));
  return false;
}

std::string SceneCheck::other_kind(const std::string& name, std::string remedy) const {
  if (const auto joint = joints_.find(name); joint != joints_.end())
    return fmt::format("'{}' is a joint; the link that it moves is '{}'", name,
                       robot_.links[static_cast<size_t>(robot_.joints[static_cast<size_t>(joint->second)].child)].name);
  if (const auto link = links_.find(name); link != links_.end())
    for (const ir::Joint& joint : robot_.joints)
      if (joint.child == link->second) return fmt::format("'{}' is a link; the joint that moves it is '{}'", name, joint.name);
  return remedy;
}

Place SceneCheck::place_of(const std::string& where) const {
  constexpr std::string_view of_mimic = "mimic/";
  if (document_.urdf_mimic && where.starts_with(of_mimic)) {
    const std::string name = where.substr(of_mimic.size(), where.find(part_of_entry) - of_mimic.size());
    return {robot_.file, fmt::format("joint '{}' (line {})", name, robot_.joints[static_cast<size_t>(joints_.at(name))].line)};
  }
  auto found = document_.places.find(where);
  if (found == document_.places.end()) found = document_.places.find(where.substr(0, where.find('/')));
  if (found != document_.places.end()) return found->second;
  return {robot_.file, ""};  // neither written in the scene nor on the command line: the URDF's
}

void SceneCheck::error(const std::string& where, std::string message, std::string remedy) {
  const Place place = place_of(where);
  add_error(errors_, {Severity::error, place.file, place.element, std::move(message), std::move(remedy)});
}

ir::Base default_base(const ir::RobotDescription& robot) {
  if (!robot.floating_root.empty()) return ir::Base::floating;
  if (robot.links[static_cast<size_t>(robot.root)].name == "world") return ir::Base::fixed;
  std::vector<int> welded{robot.root};
  for (size_t i = 0; i < welded.size(); ++i) {
    const size_t link = static_cast<size_t>(welded[i]);
    if (robot.links[link].inertia) return ir::Base::floating;
    for (int j : robot.children[link])
      if (const ir::Joint& joint = robot.joints[static_cast<size_t>(j)]; joint.type == ir::JointType::fixed)
        welded.push_back(joint.child);
  }
  return ir::Base::fixed;
}

ir::Scene check_scene(const SceneDocument& document, const ir::RobotDescription& robot, Diagnostics& warnings) {
  return SceneCheck(document, robot, warnings).run();
}

}  // namespace dalembert::frontend
