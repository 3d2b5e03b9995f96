#include "frontend/scene_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <optional>

#include "frontend/nearest.hpp"
#include "frontend/numbers.hpp"
#include "frontend/setting_text.hpp"
#include "frontend/text_file.hpp"

namespace dalembert::frontend {

namespace {

// Reads one key after another into the document. `file` is empty on the command line.
class SceneReader {
 public:
  using Handler = void (SceneReader::*)(const YAML::Node&);
  struct Key {
    const char* name;
    Handler read;
  };
  static const std::vector<Key>& keys() {
    static const std::vector<Key> keys = {
        {"base", &SceneReader::base},           {"gravity", &SceneReader::gravity},   {"outputs", &SceneReader::outputs},
        {"locked", &SceneReader::locked},       {"cut", &SceneReader::cut},           {"mimic", &SceneReader::mimic},
        {"jacobians", &SceneReader::jacobians}, {"payloads", &SceneReader::payloads}, {"armature", &SceneReader::armature},
        {"damping", &SceneReader::damping},     {"friction", &SceneReader::friction}, {"rates_zero", &SceneReader::rates_zero},
        {"scalar", &SceneReader::scalar},       {"parallel", &SceneReader::parallel}};
    return keys;
  }

  SceneReader(SceneDocument& document, std::string file)
      : document_(document), scene_(document.scene), file_(std::move(file)) {}

  void read(const std::string& key, const YAML::Node& name, const YAML::Node& value) {
    key_ = key;
    for (const Key& known : keys()) {
      if (key != known.name) continue;
      document_.given.insert(key);
      document_.places[key] = place(name);
      (this->*known.read)(value);
      return;
    }
    refuse(name, fmt::format("the key '{}' is unknown", key), suggestion(key, scene_keys()));
  }

  Place place(const YAML::Node& node) const {
    if (file_.empty()) return {"", "option --" + std::string(key_)};
    return {file_, fmt::format("line {}, column {}: key '{}'", node.Mark().line + 1, node.Mark().column + 1, key_)};
  }

  [[noreturn]] void refuse(const YAML::Node& node, std::string message, std::string remedy) const {
    const Place at = place(node);
    throw InputError({Severity::error, at.file, at.element, std::move(message), std::move(remedy)});
  }

 private:
  void base(const YAML::Node& node) {
    scene_.base = choice<ir::Base>(node, {{"fixed", ir::Base::fixed}, {"floating", ir::Base::floating}});
  }
  void scalar(const YAML::Node& node) {
    scene_.scalar = choice<ir::ScalarType>(node, {{"double", ir::ScalarType::float64}, {"float", ir::ScalarType::float32}});
  }
  void parallel(const YAML::Node& node) {
    scene_.parallel = choice<ir::Parallel>(
        node, {{"serial", ir::Parallel::serial}, {"tasks", ir::Parallel::tasks}, {"auto", ir::Parallel::automatic}});
  }
  void rates_zero(const YAML::Node& node) { scene_.rates_zero = choice<bool>(node, {{"true", true}, {"false", false}}); }

  // [x, y, z], none, run_time, or {run_time: [x, y, z]}
  void gravity(const YAML::Node& node) {
    const std::string remedy = "write [0, 0, -9.81], none, run_time, or {run_time: [0, 0, -9.81]}";
    scene_.gravity = ir::Scene{}.gravity;
    scene_.gravity_kind = ir::GravityKind::constant;
    if (node.IsSequence()) {
      scene_.gravity = vector(node, remedy);
    } else if (node.IsScalar() && node.Scalar() == "none") {
      scene_.gravity_kind = ir::GravityKind::none;
      scene_.gravity.setZero();
    } else if (node.IsScalar() && node.Scalar() == "run_time") {
      scene_.gravity_kind = ir::GravityKind::run_time;
    } else if (node.IsMap() && node.size() == 1 && node.begin()->first.IsScalar() &&
               node.begin()->first.Scalar() == "run_time") {
      scene_.gravity_kind = ir::GravityKind::run_time;
      scene_.gravity = vector(node.begin()->second, remedy);
    } else {
      refuse(node, "the value is no gravity", remedy);
    }
  }

  void outputs(const YAML::Node& node) {
    std::vector<std::string> known;
    for (ir::Quantity quantity : ir::all_quantities) known.emplace_back(name_of(quantity));
    scene_.outputs.clear();
    for (const YAML::Node& item : list(node, "a list of quantities")) {
      const std::optional<ir::Quantity> quantity = ir::quantity_named(item.Scalar());
      if (!quantity) refuse(item, fmt::format("the quantity '{}' is unknown", item.Scalar()), suggestion(item.Scalar(), known));
      scene_.outputs.push_back(*quantity);
    }
  }

  // {joint: value, ...}, or [joint, ...] for zero
  void locked(const YAML::Node& node) {
    scene_.locked.clear();
    if (node.IsMap()) scene_.locked = values(node, "");
    else
      for (const YAML::Node& item : list(node, "a map from joints to values, or a list of joints to lock at zero"))
        scene_.locked[item.Scalar()] = 0;
  }
  void cut(const YAML::Node& node) {
    scene_.cut.clear();
    for (const YAML::Node& item : list(node, "a list of links")) scene_.cut.insert(item.Scalar());
  }
  void jacobians(const YAML::Node& node) { scene_.jacobians = names(node, "a list of links"); }
  void payloads(const YAML::Node& node) { scene_.payloads = names(node, "a list of links"); }

  void armature(const YAML::Node& node) { scene_.armature = positive_values(node, false); }
  void damping(const YAML::Node& node) {
    scene_.urdf_damping = says_urdf(node);
    scene_.damping = scene_.urdf_damping ? std::map<std::string, double>{} : positive_values(node, true);
  }
  void friction(const YAML::Node& node) {
    scene_.urdf_friction = says_urdf(node);
    scene_.friction = scene_.urdf_friction ? std::map<std::string, double>{} : positive_values(node, true);
  }

  // {joint: {of: joint, multiplier: 1, offset: 0}, ...} or urdf
  void mimic(const YAML::Node& node) {
    scene_.mimic.clear();
    forget_entries();
    document_.urdf_mimic = says_urdf(node);
    if (document_.urdf_mimic) return;
    const std::string remedy =
        "write {joint: {of: other_joint, multiplier: 1, offset: 0}}, or urdf to take the URDF's relations";
    if (!node.IsMap()) refuse(node, "the value is no map of mimic relations", remedy);
    for (const auto& entry : node) {
      const std::string joint = entry_name(entry.first);
      if (!entry.second.IsMap()) refuse(entry.second, fmt::format("the relation of '{}' is not a map", joint), remedy);
      ir::Mimic relation;
      for (const auto& part : entry.second) {
        const std::string name = entry_name(part.first, joint);
        if (name == "of" && part.second.IsScalar()) relation.of = part.second.Scalar();
        else if (name == "multiplier") relation.multiplier = number(part.second);
        else if (name == "offset") relation.offset = number(part.second);
        else
          refuse(part.first, fmt::format("'{}' is no part of a mimic relation", name),
                 suggestion(name, {"of", "multiplier", "offset"}));
      }
      if (relation.of.empty())
        refuse(entry.first, fmt::format("the relation of '{}' does not say which joint drives it", joint), remedy);
      scene_.mimic[joint] = relation;
    }
  }

  template <class T>
  T choice(const YAML::Node& node, const std::vector<std::pair<std::string, T>>& choices) const {
    std::vector<std::string> names;
    for (const auto& [name, value] : choices) {
      if (node.IsScalar() && node.Scalar() == name) return value;
      names.push_back(name);
    }
    const std::string given = node.IsScalar() ? fmt::format("'{}'", node.Scalar()) : "the value";
    refuse(node, fmt::format("{} is unknown", given), fmt::format("choose from {}", fmt::join(names, ", ")));
  }

  double number(const YAML::Node& node) const {
    if (!node.IsScalar()) refuse(node, "the value is not a number", "write a finite decimal number");
    const std::optional<double> value = parse_number(node.Scalar());
    if (!value || !std::isfinite(*value))
      refuse(node, fmt::format("'{}' is not a finite number", node.Scalar()), "write a finite decimal number");
    return *value;
  }

  Eigen::Vector3d vector(const YAML::Node& node, const std::string& remedy) const {
    if (!node.IsSequence() || node.size() != 3) refuse(node, "the vector does not have three numbers", remedy);
    return {number(node[0]), number(node[1]), number(node[2])};
  }

  // A list of scalars without repetition; one scalar alone is a list of one. Records each item's place.
  std::vector<YAML::Node> list(const YAML::Node& node, const std::string& expected) {
    std::vector<YAML::Node> items;
    if (node.IsScalar()) items.push_back(node);
    else if (node.IsSequence())
      for (const YAML::Node& item : node) items.push_back(item);
    else refuse(node, "the value is not a list", "write " + expected);
    forget_entries();
    for (const YAML::Node& item : items) {
      if (!item.IsScalar() || item.Scalar().empty()) refuse(item, "an item of the list is not a name", "write " + expected);
      entry_name(item);
    }
    return items;
  }
  std::vector<std::string> names(const YAML::Node& node, const std::string& expected) {
    std::vector<std::string> names;
    for (const YAML::Node& item : list(node, expected)) names.push_back(item.Scalar());
    return names;
  }

  // `otherwise`: what else the remedy offers.
  std::map<std::string, double> values(const YAML::Node& node, const std::string& otherwise) {
    if (!node.IsMap()) refuse(node, "the value is not a map", fmt::format("write {}: {{joint: value}}{}", key_, otherwise));
    forget_entries();
    std::map<std::string, double> values;
    for (const auto& entry : node) {
      const std::string joint = entry_name(entry.first);
      values[joint] = number(entry.second);
    }
    return values;
  }
  std::map<std::string, double> positive_values(const YAML::Node& node, bool in_urdf) {
    std::map<std::string, double> values = this->values(node, in_urdf ? ", or urdf to take the URDF's values" : "");
    for (const auto& entry : node)
      if (const std::string& joint = entry.first.Scalar(); values.at(joint) < 0)
        refuse(entry.second, fmt::format("the {} of joint '{}' is negative", key_, joint), "give a value of zero or more");
    return values;
  }

  static bool says_urdf(const YAML::Node& node) { return node.IsScalar() && node.Scalar() == "urdf"; }

  // The name of an entry; notes its place, and refuses one that is given twice.
  std::string entry_name(const YAML::Node& node, const std::string& inside = "") {
    if (!node.IsScalar()) refuse(node, "a name was expected", "write the name of a joint or link");
    std::string entry = std::string(key_) + "/";
    if (!inside.empty()) entry += inside + "/";
    entry += node.Scalar();
    if (!document_.places.emplace(entry, place(node)).second)
      refuse(node, fmt::format("'{}' is given twice", node.Scalar()), "keep one of them");
    return node.Scalar();
  }
  void forget_entries() {
    std::erase_if(document_.places, [&](const auto& p) { return p.first.starts_with(key_ + "/"); });
  }

  SceneDocument& document_;
  ir::Scene& scene_;
  std::string file_;
  std::string key_;
};

void read_file(SceneDocument& document, const std::string& file, const std::string& text) {
  std::vector<YAML::Node> documents;
  try {
    documents = YAML::LoadAll(text);
  } catch (const YAML::Exception& error) {
    throw InputError({Severity::error, file, fmt::format("line {}, column {}", error.mark.line + 1, error.mark.column + 1),
                      "this is not YAML: " + error.msg, "docs/scene.md shows how a scene is written"});
  }
  std::erase_if(documents, [](const YAML::Node& node) { return node.IsNull(); });
  if (documents.empty()) return;
  const auto line_of = [](const YAML::Node& node) {
    return fmt::format("line {}, column {}", node.Mark().line + 1, node.Mark().column + 1);
  };
  if (documents.size() > 1)
    throw InputError({Severity::error, file, line_of(documents[1]), "a second document begins here",
                      "a scene is one document: remove the line '---' and what is not needed"});
  const YAML::Node& root = documents.front();
  SceneReader reader(document, file);
  if (!root.IsMap())
    throw InputError(
        {Severity::error, file, line_of(root), "a scene is a map of keys to values", "write lines such as 'base: fixed'"});
  for (const auto& entry : root) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
    const bool twice = document.given.count(key) > 0;
    reader.read(key, entry.first, entry.second);
    if (twice) reader.refuse(entry.first, "the key is given twice", "keep one of them");
  }
}

}  // namespace

const std::vector<std::string>& scene_keys() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> names;
    for (const SceneReader::Key& key : SceneReader::keys()) names.emplace_back(key.name);
    return names;
  }();
  return names;
}

SceneDocument read_scene(const std::string& file, const std::vector<Setting>& settings) {
  return read_scene_text(file, file.empty() ? "" : read_text_file(file, "scene"), settings);
}

SceneDocument read_scene_text(const std::string& file, const std::string& text, const std::vector<Setting>& settings) {
  SceneDocument document;
  if (!file.empty()) read_file(document, file, text);
  for (const Setting& setting : settings) {
    YAML::Node value;
    try {
      value = node_of(setting.text);
    } catch (const YAML::Exception& error) {
      throw InputError({Severity::error, "", "option --" + setting.key, "the value is not YAML: " + error.msg,
                        "docs/scene.md shows how it is written"});
    }
    SceneReader(document, "").read(setting.key, YAML::Node(setting.key), value);
  }
  return document;
}

}  // namespace dalembert::frontend
