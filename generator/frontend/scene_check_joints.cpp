// What joints are.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "frontend/nearest.hpp"
#include "frontend/scene_checks.hpp"

namespace dalembert::frontend {

namespace {

std::string not_usable(double value) { return std::isfinite(value) ? fmt::format("negative ({})", value) : "no finite number"; }

}  // namespace

void SceneCheck::kinds() {
  for (const auto& [name, kind] : scene_.joints) {
    if (!moving_joint("joints", name)) continue;
    const ir::Joint& joint = robot_.joints[static_cast<size_t>(joints_.at(name))];
    if (ir::row_of(kind.type).has_axis && !joint.axis_is_known)
      error("joints/" + name,
            fmt::format("joint '{}' is {} in the URDF and has no <axis> there", name, ir::row_of(joint.type).word),
            "give it one in the URDF: <axis xyz=\"0 0 1\"/> or another direction");
    else if (kind.type == ir::JointType::universal && joint.axis.cross(kind.second).norm() < 1e-9)
      error("joints/" + name, fmt::format("the second axis of joint '{}' is its first: together they turn one way", name),
            "give the axis of the cross's other pin, in the child link's frame");
    if (!ir::turns(joint.type) && kind.type == ir::JointType::helical)
      error("joints/" + name,
            fmt::format("joint '{}' is {}: limits and losses of a screw are those of its angle", name,
                        ir::row_of(joint.type).word),
            "make it revolute or continuous in the URDF");
  }
}

void SceneCheck::locked() {
  for (const auto& [name, value] : scene_.locked)
    if (moving_joint("locked", name) && value != 0 && coordinates_of(name) > 1)
      error("locked/" + name, fmt::format("joint '{}' has {} coordinates", name, coordinates_of(name)),
            "lock it at zero, and say in the URDF's <origin> where that is");
}

void SceneCheck::mimic() {
  if (document_.urdf_mimic)
    for (const ir::Joint& joint : robot_.joints)
      if (joint.mimic && moves(joint)) scene_.mimic.emplace(joint.name, *joint.mimic);
  for (const auto& [name, relation] : scene_.mimic) {
    const std::string key = "mimic/" + name, of = key + part_of_entry + "of";
    if (document_.urdf_mimic ? !sound_in_urdf(name, relation) : !free_joint(key, name) || !free_joint(of, relation.of))
      continue;
    if (!of_one_coordinate(key, name) || !of_one_coordinate(of, relation.of)) continue;
    if (relation.of == name) error(key, fmt::format("joint '{}' drives itself", name), "name another joint as its driver");
  }
  compose_mimic();
  for (const auto& [name, relation] : scene_.mimic)
    if (relation.multiplier == 0)
      error("mimic/" + name, fmt::format("the multiplier of joint '{}' is zero: it would not move", name),
            fmt::format("lock it at its offset instead: locked: {{{}: {}}}", name, relation.offset));
}

void SceneCheck::compose_mimic() {
  std::set<std::string> walked;
  for (const auto& [first, relation] : scene_.mimic) {
    std::vector<std::string> chain;
    std::string name = first;
    for (; scene_.mimic.count(name) && walked.insert(name).second; name = scene_.mimic.at(name).of) chain.push_back(name);
    if (const auto ring = std::find(chain.begin(), chain.end(), name); chain.end() - ring > 1)
      error("mimic/" + name,
            fmt::format("joints '{}' follow one another in a ring: none moves by itself", fmt::join(ring, chain.end(), "', '")),
            "let one of them follow a joint outside of the ring, or none");
    for (size_t i = chain.size(); i-- > 0;) {
      ir::Mimic& follower = scene_.mimic.at(chain[i]);
      if (const auto driver = scene_.mimic.find(follower.of); driver != scene_.mimic.end()) {
        const ir::Mimic& its = driver->second;
        follower = {its.of, follower.multiplier * its.multiplier, follower.multiplier * its.offset + follower.offset};
      }
    }
  }
}

bool SceneCheck::sound_in_urdf(const std::string& name, const ir::Mimic& relation) {
  const std::string otherwise = "in the URDF, or write the relations in the scene: mimic: {joint: {of: other_joint}}";
  const auto refuse = [&](const std::string& message, const std::string& remedy) {
    error("mimic/" + name, message, remedy);
    return false;
  };
  if (relation.of.empty()) return refuse("its <mimic> names no joint", "correct it " + otherwise);
  if (!std::isfinite(relation.multiplier) || !std::isfinite(relation.offset))
    return refuse("its <mimic> has no finite multiplier and offset", "correct it " + otherwise);
  const auto driver = joints_.find(relation.of);
  if (driver == joints_.end()) {
    std::vector<std::string> others;  // that have a coordinate of their own
    for (const ir::Joint& joint : robot_.joints)
      if (moves(joint) && !scene_.mimic.count(joint.name)) others.push_back(joint.name);
    const std::string remedy = others.empty() ? "add that joint, or remove the <mimic>"
                                              : fmt::format("correct its <mimic> {}; {}", otherwise,
                                                            other_kind(relation.of, suggestion(relation.of, others)));
    return refuse(fmt::format("it follows joint '{}', which does not exist", relation.of), remedy);
  }
  const ir::Joint& joint = robot_.joints[static_cast<size_t>(driver->second)];
  if (is_cut(joint))
    return refuse(fmt::format("it follows joint '{}', which is cut off", relation.of),
                  fmt::format("cut it off too, lock it, or take the link that '{}' belongs to out of 'cut'", relation.of));
  if (joint.type == ir::JointType::fixed)
    return refuse(fmt::format("it follows joint '{}', which is fixed", relation.of),
                  fmt::format("lock it too: locked: {{{}: {}}}; or correct its <mimic> {}", name, relation.offset, otherwise));
  if (const auto locked = scene_.locked.find(relation.of); locked != scene_.locked.end())
    return refuse(fmt::format("it follows joint '{}', which is locked", relation.of),
                  fmt::format("lock it too: locked: {{{}: {}}}; or unlock '{}'", name,
                              relation.multiplier * locked->second + relation.offset, relation.of));
  return true;
}

void SceneCheck::stiffness() {
  for (const auto& [joint, spring] : scene_.stiffness) {
    if (!free_joint("stiffness", joint) || !of_one_coordinate("stiffness", joint)) continue;
    if (const auto relation = scene_.mimic.find(joint); relation != scene_.mimic.end())
      error("stiffness/" + joint, fmt::format("joint '{}' mimics '{}'", joint, relation->second.of),
            fmt::format("give the spring to '{}'", relation->second.of));
  }
}

void SceneCheck::elastic() {
  for (const auto& [joint, spring] : scene_.elastic)
    if (free_joint("elastic", joint) && of_one_coordinate("elastic", joint) && scene_.armature.count(joint))
      error("armature/" + joint, fmt::format("joint '{}' is elastic", joint),
            "remove it here: the inertia in 'elastic' is that of the motor");
}

void SceneCheck::urdf_values(const char* kind, double ir::Joint::*value) {
  for (const ir::Joint& joint : robot_.joints)
    if (moves(joint) && !(joint.*value >= 0 && std::isfinite(joint.*value)))
      error(kind, fmt::format("the URDF's {} of joint '{}' is {}", kind, joint.name, not_usable(joint.*value)),
            fmt::format("correct it in the URDF, or give values: {}: {{joint: value}}", kind));
}

}  // namespace dalembert::frontend
