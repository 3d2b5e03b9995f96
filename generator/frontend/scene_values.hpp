// What a key of the scene holds, read and refused with its place: numbers, words, lists, maps from joints to numbers.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "frontend/nearest.hpp"
#include "frontend/scene_reader.hpp"
#include "frontend/yaml_text.hpp"

namespace dalembert::frontend {

// Of one key after another. `file` is empty on the command line.
class SceneValues {
 public:
  SceneValues(SceneDocument& document, std::string file)
      : document_(document), scene_(document.scene), file_(std::move(file)) {}

  [[noreturn]] void refuse(const YamlNode& node, std::string message, std::string remedy) const;

 protected:
  Place place(const YamlNode& node) const;

  // One of a few words, all of which a refusal offers.
  template <class T>
  T choice(const YamlNode& node, const std::vector<std::pair<std::string, T>>& choices) const {
    std::vector<std::string> names;
    for (const auto& [name, value] : choices) {
      if (node.is_scalar() && node.scalar == name) return value;
      names.push_back(name);
    }
    const std::string given = node.is_scalar() ? fmt::format("'{}'", node.scalar) : "the value";
    refuse(node, fmt::format("{} is unknown", given), fmt::format("choose from {}", fmt::join(names, ", ")));
  }
  // One of several words, of which a refusal offers the nearest.
  template <class T>
  T word(const YamlNode& node, const std::vector<std::pair<std::string, T>>& words) const {
    std::vector<std::string> names;
    for (const auto& [name, value] : words) {
      if (node.is_scalar() && node.scalar == name) return value;
      names.push_back(name);
    }
    refuse(node, node.is_scalar() ? fmt::format("'{}' is unknown", node.scalar) : "the value is unknown",
           suggestion(node.is_scalar() ? node.scalar : "", names));
  }
  // The same for the type of a contact or loop.
  template <class T>
  T type_of(const char* kind, const YamlNode& node, const std::vector<std::pair<std::string, T>>& types) const {
    std::vector<std::string> names;
    for (const auto& [name, type] : types) {
      if (node.is_scalar() && node.scalar == name) return type;
      names.push_back(name);
    }
    const std::string given = node.is_scalar() ? node.scalar : "";
    refuse(node,
           given.empty() ? fmt::format("the type of a {} is no word", kind) : fmt::format("'{}' is no type of {}", given, kind),
           suggestion(given, names));
  }

  double number(const YamlNode& node) const;
  Eigen::Vector3d vector(const YamlNode& node, const std::string& remedy) const;
  // A list of scalars without repetition; one scalar alone is a list of one. Records each item's place.
  std::vector<YamlNode> list(const YamlNode& node, const std::string& expected);
  std::vector<std::string> names(const YamlNode& node, const std::string& expected);
  // {joint: number, ...}
  // `otherwise`: what else the remedy offers.
  std::map<std::string, double> values(const YamlNode& node, const std::string& otherwise);
  std::map<std::string, double> positive_values(const YamlNode& node, bool in_urdf);
  // The name of an entry; notes its place, and refuses one that is given twice.
  std::string entry_name(const YamlNode& node, const std::string& inside = "");
  // Places of the key's entries: it replaces what was given before.
  void forget_entries();
  static bool says_urdf(const YamlNode& node) { return node.is_scalar() && node.scalar == "urdf"; }

  SceneDocument& document_;
  ir::Scene& scene_;
  std::string file_;
  std::string key_, entry_;  // entry: the last that was named
};

}  // namespace dalembert::frontend
