// What links carry and are held by.
#include <fmt/format.h>

#include <algorithm>

#include "frontend/nearest.hpp"
#include "frontend/scene_keys.hpp"
#include "ir/constraint_words.hpp"
#include "ir/rotation.hpp"

namespace dalembert::frontend {

namespace {

constexpr const char* pose_remedy =
    "write at: [[0.1, 0, 0, 0, 0, 0], [0, 0, 0.2, 0, 0, 1.57]], on each link x y z (m) "
    "and roll pitch yaw (rad), or x y z alone";

}  // namespace

std::string SceneKeys::link_of(const char* kind, const std::string& name, const YamlNode& node) const {
  if (!node.is_scalar() || node.scalar.empty())
    refuse(node, fmt::format("what {} '{}' is on is not the name of a link", kind, name), "write link: left_foot");
  return node.scalar;
}

void SceneKeys::place_on_link(const YamlNode& node, Eigen::Vector3d& xyz, Eigen::Vector3d* rpy) const {
  const std::string remedy = rpy ? "write at: [0.1, 0, -0.02] or at: [0.1, 0, -0.02, 0, 0, 1.57], m and rad in the link's frame"
                                 : "write at: [0.1, 0, -0.02], m in the link's frame";
  if (!rpy || !node.is_sequence() || node.items.size() == 3) {
    xyz = vector(node, remedy);
    return;
  }
  if (node.items.size() != 6) refuse(node, "the place has neither three numbers nor six", remedy);
  for (int i = 0; i < 3; ++i) {
    xyz[i] = number(node.items[static_cast<size_t>(i)]);
    (*rpy)[i] = number(node.items[static_cast<size_t>(i) + 3]);
  }
}

void SceneKeys::payloads(const YamlNode& node) { scene_.payloads = names(node, "a list of links"); }

void SceneKeys::wrenches(const YamlNode& node) {
  scene_.wrenches.clear();
  if (!node.is_map()) {
    for (std::string& link : names(node, "a list of links, or {link: world}"))
      scene_.wrenches.push_back({std::move(link), false});
    return;
  }
  forget_entries();
  for (const auto& entry : node.entries) {
    const std::string link = entry_name(entry.key);
    scene_.wrenches.push_back({link, choice<bool>(entry.value, {{"link", false}, {"world", true}})});
  }
}

void SceneKeys::contacts(const YamlNode& node) {
  scene_.contacts.clear();
  forget_entries();
  if (node.is_sequence() && node.items.empty()) return;
  const std::string remedy =
      "write contacts: {left_foot: weld, toe: {link: right_foot, type: point, at: [0.1, 0, -0.02], axes: world}}";
  if (!node.is_map()) refuse(node, "the value is no map of contacts", remedy);
  for (const auto& entry : node.entries) {
    ir::Contact contact;
    contact.name = contact.link = entry_name(entry.key);
    if (entry.value.is_scalar()) {
      contact.type = type_of("contact", entry.value, ir::contact_words());
    } else if (entry.value.is_map()) {
      for (const auto& part : entry.value.entries) part_of_contact(contact, part);
    } else {
      refuse(entry.value, fmt::format("contact '{}' is neither a type nor a map", contact.name), remedy);
    }
    scene_.contacts.push_back(std::move(contact));
  }
}

void SceneKeys::part_of_contact(ir::Contact& contact, const YamlEntry& part) {
  const std::string name = entry_name(part.key, contact.name);
  if (name == "link") {
    contact.link = link_of("contact", contact.name, part.value);
  } else if (name == "type") {
    contact.type = type_of("contact", part.value, ir::contact_words());
  } else if (name == "at") {
    place_on_link(part.value, contact.at, nullptr);
  } else if (name == "axes") {
    contact.along_link = choice<bool>(part.value, {{"world", false}, {"link", true}});
  } else {
    refuse(part.key, fmt::format("'{}' is no part of a contact", name), suggestion(name, {"link", "type", "at", "axes"}));
  }
}

void SceneKeys::loops(const YamlNode& node) {
  scene_.loops.clear();
  scene_.embedded.clear();
  forget_entries();
  if (node.is_sequence() && node.items.empty()) return;
  const std::string remedy =
      "write loops: {rod: {links: [crank, rod], at: [[0.1, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0]], type: hinge}}";
  if (!node.is_map()) refuse(node, "the value is no map of loops", remedy);
  for (const auto& entry : node.entries) {
    ir::Loop loop;
    loop.name = entry_name(entry.key);
    if (!entry.value.is_map()) refuse(entry.value, fmt::format("loop '{}' is no map", loop.name), remedy);
    bool typed = false;
    for (const auto& part : entry.value.entries) {
      part_of_loop(loop, part);
      typed = typed || part.key.scalar == "type";
    }
    if (loop.links[0].empty())
      refuse(entry.key, fmt::format("loop '{}' does not say which links it holds together", loop.name), remedy);
    if (!typed) refuse(entry.key, fmt::format("loop '{}' does not say of which type it is", loop.name), remedy);
    if (loop.length && loop.type != ir::LoopType::distance)
      refuse(entry.key, fmt::format("loop '{}' has a length and is no distance", loop.name),
             "remove length, or write type: distance");
    (loop.independent.empty() ? scene_.loops : scene_.embedded).push_back(std::move(loop));
  }
}

void SceneKeys::part_of_loop(ir::Loop& loop, const YamlEntry& part) {
  const std::string name = entry_name(part.key, loop.name);
  if (name == "links") {
    const std::string remedy = "write links: [crank, rod]";
    if (!part.value.is_sequence() || part.value.items.size() != 2)
      refuse(part.value, fmt::format("what loop '{}' holds together is not two links", loop.name), remedy);
    for (std::size_t i = 0; i < 2; ++i) {
      const YamlNode& link = part.value.items[i];
      if (!link.is_scalar() || link.scalar.empty())
        refuse(link, fmt::format("a link of loop '{}' is no name", loop.name), remedy);
      loop.links[i] = link.scalar;
    }
  } else if (name == "at") {
    if (!part.value.is_sequence() || part.value.items.size() != 2)
      refuse(part.value, fmt::format("where loop '{}' holds is not two poses", loop.name), pose_remedy);
    for (std::size_t i = 0; i < 2; ++i) loop.at[i] = pose(part.value.items[i]);
  } else if (name == "type") {
    loop.type = type_of("loop", part.value, ir::loop_words());
  } else if (name == "length") {
    loop.length = number(part.value);
    if (!(*loop.length > 0))
      refuse(part.value, fmt::format("the length of loop '{}' is not positive", loop.name),
             "give a value above zero; points that coincide are type: point");
  } else if (name == "independent") {
    const std::string remedy = "write independent: [motor], or leave it out: the loop has rows then";
    if (!part.value.is_sequence() || part.value.items.empty())
      refuse(part.value, fmt::format("the independent joints of loop '{}' are no list of names", loop.name), remedy);
    for (const YamlNode& joint : part.value.items) {
      if (!joint.is_scalar() || joint.scalar.empty())
        refuse(joint, fmt::format("an independent joint of loop '{}' is no name", loop.name), remedy);
      if (std::find(loop.independent.begin(), loop.independent.end(), joint.scalar) != loop.independent.end())
        refuse(joint, fmt::format("loop '{}' names the independent joint '{}' twice", loop.name, joint.scalar), "name it once");
      loop.independent.push_back(joint.scalar);
    }
  } else {
    refuse(part.key, fmt::format("'{}' is no part of a loop", name),
           suggestion(name, {"links", "at", "type", "length", "independent"}));
  }
}

Eigen::Isometry3d SceneKeys::pose(const YamlNode& node) const {
  if (!node.is_sequence() || (node.items.size() != 3 && node.items.size() != 6))
    refuse(node, "a pose does not have six numbers, or three", pose_remedy);
  Eigen::Vector3d parts[2] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (std::size_t i = 0; i < node.items.size(); ++i) parts[i / 3][static_cast<Eigen::Index>(i % 3)] = number(node.items[i]);
  Eigen::Isometry3d made = Eigen::Isometry3d::Identity();
  made.linear() = ir::without_rounding_dust(ir::rotation_from_rpy(parts[1]));
  made.translation() = parts[0];
  return made;
}

}  // namespace dalembert::frontend
