// What joints are.
#include <fmt/format.h>

#include <algorithm>

#include "frontend/nearest.hpp"
#include "frontend/scene_keys.hpp"
#include "ir/aliases.hpp"

namespace dalembert::frontend {

void SceneKeys::locked(const YamlNode& node) {
  scene_.locked.clear();
  if (node.is_map()) scene_.locked = values(node, "");
  else
    for (const YamlNode& item : list(node, "a map from joints to values, or a list of joints to lock at zero"))
      scene_.locked[item.scalar] = 0;
}

void SceneKeys::cut(const YamlNode& node) {
  scene_.cut.clear();
  for (const YamlNode& item : list(node, "a list of links")) scene_.cut.insert(item.scalar);
}

void SceneKeys::joints(const YamlNode& node) {
  scene_.joints.clear();
  forget_entries();
  const std::string remedy = "write joints: {lead: {helical: 0.005}, wrist: {universal: [0, 1, 0]}, plate: planar}";
  if (node.is_sequence() && node.items.empty()) return;
  if (!node.is_map()) refuse(node, "the value is no map from joints to what they are", remedy);
  for (const auto& entry : node.entries) {
    const std::string joint = entry_name(entry.key);
    if (!entry.value.is_scalar() && !(entry.value.is_map() && entry.value.entries.size() == 1))
      refuse(entry.value, fmt::format("what is said of joint '{}' is neither a word nor a map of one", joint), remedy);
    const bool alone = entry.value.is_scalar();
    const YamlNode& word = alone ? entry.value : entry.value.entries.front().key;
    ir::JointKind& kind = scene_.joints[joint];
    kind.type = this->word(word, ir::joint_words());
    const bool takes = kind.type == ir::JointType::helical || kind.type == ir::JointType::universal;
    if (alone == takes)
      refuse(word,
             alone ? fmt::format("joint '{}' is {}, which needs {}", joint, word.scalar,
                                 kind.type == ir::JointType::helical ? "a pitch in m per turn" : "a second axis")
                   : fmt::format("'{}' takes no value", word.scalar),
             remedy);
    if (kind.type == ir::JointType::helical) kind.pitch = number(entry.value.entries.front().value);
    if (kind.type == ir::JointType::universal) {
      kind.second = vector(entry.value.entries.front().value, "write three numbers, in the child link's frame: " + remedy);
      if (!(kind.second.norm() > 0)) refuse(word, fmt::format("the second axis of joint '{}' is zero", joint), remedy);
      kind.second = kind.second.stableNormalized();
    }
  }
}

void SceneKeys::mimic(const YamlNode& node) {
  scene_.mimic.clear();
  forget_entries();
  document_.urdf_mimic = says_urdf(node);
  if (document_.urdf_mimic) return;
  const std::string remedy = "write {joint: {of: other_joint, multiplier: 1, offset: 0}}, or urdf to take the URDF's relations";
  if (!node.is_map()) refuse(node, "the value is no map of mimic relations", remedy);
  for (const auto& entry : node.entries) {
    const std::string joint = entry_name(entry.key);
    if (!entry.value.is_map()) refuse(entry.value, fmt::format("the relation of '{}' is not a map", joint), remedy);
    ir::Mimic relation;
    for (const auto& part : entry.value.entries) {
      const std::string name = entry_name(part.key, joint);
      if (name == "of") relation.of = driver(joint, part.value);
      else if (name == "multiplier") relation.multiplier = number(part.value);
      else if (name == "offset") relation.offset = number(part.value);
      else
        refuse(part.key, fmt::format("'{}' is no part of a mimic relation", name),
               suggestion(name, {"of", "multiplier", "offset"}));
    }
    if (relation.of.empty())
      refuse(entry.key, fmt::format("the relation of '{}' does not say which joint drives it", joint), remedy);
    scene_.mimic[joint] = relation;
  }
}

std::string SceneKeys::driver(const std::string& joint, const YamlNode& node) const {
  if (!node.is_scalar())
    refuse(node, fmt::format("what drives '{}' is not the name of a joint", joint), "write of: other_joint");
  return node.scalar;
}

void SceneKeys::passive(const YamlNode& node) { scene_.passive = names(node, "a list of joints"); }

void SceneKeys::armature(const YamlNode& node) { scene_.armature = positive_values(node, false); }

void SceneKeys::damping(const YamlNode& node) {
  scene_.urdf_damping = says_urdf(node);
  scene_.damping = scene_.urdf_damping ? std::map<std::string, double>{} : positive_values(node, true);
}

void SceneKeys::friction(const YamlNode& node) {
  scene_.urdf_friction = says_urdf(node);
  scene_.friction = scene_.urdf_friction ? std::map<std::string, double>{} : positive_values(node, true);
}

void SceneKeys::stiffness(const YamlNode& node) {
  scene_.stiffness.clear();
  forget_entries();
  const std::string remedy = "write stiffness: {joint: {k: 100, rest: 0}}, or {joint: 100} for a spring at rest at zero";
  if (!node.is_map()) refuse(node, "the value is not a map", remedy);
  for (const auto& entry : node.entries) {
    const std::string joint = entry_name(entry.key);
    std::map<std::string, const YamlNode*> parts{{"k", &entry.value}};
    if (!entry.value.is_scalar()) parts = parts_of_spring(joint, entry, {"k", "rest"}, {"k"}, remedy);
    ir::Spring& spring = scene_.stiffness[joint];
    spring.k = number(*parts.at("k"));
    if (spring.k < 0)
      refuse(*parts.at("k"), fmt::format("the stiffness of joint '{}' is negative", joint), "give a value of zero or more");
    if (parts.contains("rest")) spring.rest = number(*parts.at("rest"));
  }
}

void SceneKeys::elastic(const YamlNode& node) {
  scene_.elastic.clear();
  forget_entries();
  const std::string remedy = "write elastic: {joint: {k: 1000, inertia: 0.3, damping: 1}}";
  if (!node.is_map()) refuse(node, "the value is not a map", remedy);
  for (const auto& entry : node.entries) {
    const std::string joint = entry_name(entry.key);
    const auto parts = parts_of_spring(joint, entry, {"k", "inertia", "damping"}, {"k", "inertia"}, remedy);
    const auto positive = [&](const char* part) {
      const double value = number(*parts.at(part));
      if (value <= 0)
        refuse(*parts.at(part), fmt::format("the {} of elastic joint '{}' is not positive", part, joint),
               "give a value above zero; a joint left out is rigid");
      return value;
    };
    ir::Elasticity& made = scene_.elastic[joint];
    made.k = positive("k");
    made.inertia = positive("inertia");
    if (!parts.contains("damping")) continue;
    made.damping = number(*parts.at("damping"));
    if (made.damping < 0)
      refuse(*parts.at("damping"), fmt::format("the damping of elastic joint '{}' is negative", joint),
             "give a value of zero or more");
  }
}

std::map<std::string, const YamlNode*> SceneKeys::parts_of_spring(const std::string& joint, const YamlEntry& entry,
                                                                  const std::vector<std::string>& known,
                                                                  const std::vector<std::string>& needed,
                                                                  const std::string& remedy) {
  if (!entry.value.is_map()) refuse(entry.value, fmt::format("the spring of '{}' is no map", joint), remedy);
  std::map<std::string, const YamlNode*> parts;
  for (const auto& part : entry.value.entries) {
    const std::string name = entry_name(part.key, joint);
    if (std::find(known.begin(), known.end(), name) == known.end())
      refuse(part.key, fmt::format("'{}' is no part of a spring", name), suggestion(name, known));
    parts[name] = &part.value;
  }
  for (const std::string& name : needed)
    if (!parts.contains(name)) refuse(entry.key, fmt::format("the spring of '{}' has no {}", joint, name), remedy);
  return parts;
}

}  // namespace dalembert::frontend
