#include "frontend/scene_values.hpp"

#include <cmath>
#include <optional>

#include "frontend/numbers.hpp"

namespace dalembert::frontend {

Place SceneValues::place(const YamlNode& node) const {
  if (file_.empty()) return {"", "option --" + std::string(key_)};
  return {file_, fmt::format("line {}, column {}: key '{}'", node.line, node.column, key_)};
}

void SceneValues::refuse(const YamlNode& node, std::string message, std::string remedy) const {
  const Place at = place(node);
  throw InputError({Severity::error, at.file, at.element, std::move(message), std::move(remedy)});
}

double SceneValues::number(const YamlNode& node) const {
  if (!node.is_scalar()) refuse(node, "the value is not a number", "write a finite decimal number");
  const std::optional<double> value = parse_number(node.scalar);
  if (!value || !std::isfinite(*value))
    refuse(node, fmt::format("'{}' is not a finite number", node.scalar), "write a finite decimal number");
  if (SceneDocument::Number& largest = document_.largest[key_]; std::abs(*value) > largest.size)
    largest = {std::abs(*value), node.scalar, entry_, place(node)};
  return *value;
}

Eigen::Vector3d SceneValues::vector(const YamlNode& node, const std::string& remedy) const {
  if (!node.is_sequence() || node.items.size() != 3) refuse(node, "the vector does not have three numbers", remedy);
  return {number(node.items[0]), number(node.items[1]), number(node.items[2])};
}

std::vector<YamlNode> SceneValues::list(const YamlNode& node, const std::string& expected) {
  std::vector<YamlNode> items;
  if (node.is_scalar()) items.push_back(node);
  else if (node.is_sequence()) items = node.items;
  else refuse(node, "the value is not a list", "write " + expected);
  forget_entries();
  for (const YamlNode& item : items) {
    if (!item.is_scalar() || item.scalar.empty()) refuse(item, "an item of the list is not a name", "write " + expected);
    entry_name(item);
  }
  return items;
}

std::vector<std::string> SceneValues::names(const YamlNode& node, const std::string& expected) {
  std::vector<std::string> names;
  for (const YamlNode& item : list(node, expected)) names.push_back(item.scalar);
  return names;
}

std::map<std::string, double> SceneValues::values(const YamlNode& node, const std::string& otherwise) {
  if (!node.is_map()) refuse(node, "the value is not a map", fmt::format("write {}: {{joint: value}}{}", key_, otherwise));
  forget_entries();
  std::map<std::string, double> values;
  for (const auto& entry : node.entries) {
    const std::string joint = entry_name(entry.key);
    values[joint] = number(entry.value);
  }
  return values;
}

std::map<std::string, double> SceneValues::positive_values(const YamlNode& node, bool in_urdf) {
  std::map<std::string, double> values = this->values(node, in_urdf ? ", or urdf to take the URDF's values" : "");
  for (const auto& entry : node.entries)
    if (const std::string& joint = entry.key.scalar; values.at(joint) < 0)
      refuse(entry.value, fmt::format("the {} of joint '{}' is negative", key_, joint), "give a value of zero or more");
  return values;
}

std::string SceneValues::entry_name(const YamlNode& node, const std::string& inside) {
  if (!node.is_scalar()) refuse(node, "a name was expected", "write the name of a joint or link");
  std::string entry = key_ + "/";
  if (!inside.empty()) entry += inside + part_of_entry;
  entry += node.scalar;
  entry_ = inside.empty() ? node.scalar : inside;
  if (!document_.places.emplace(entry, place(node)).second)
    refuse(node, fmt::format("'{}' is given twice", node.scalar), "keep one of them");
  return node.scalar;
}

void SceneValues::forget_entries() {
  std::erase_if(document_.places, [&](const auto& p) { return p.first.starts_with(key_ + "/"); });
}

}  // namespace dalembert::frontend
