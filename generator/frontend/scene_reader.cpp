#include "frontend/scene_reader.hpp"

#include <fmt/format.h>

#include <optional>

#include "frontend/scene_keys.hpp"
#include "frontend/setting_text.hpp"
#include "frontend/text_encoding.hpp"
#include "frontend/text_file.hpp"
#include "frontend/yaml_text.hpp"
#include "ir/magnitudes.hpp"

namespace dalembert::frontend {

namespace {

// Which number type there is to be is known behind the last key.
void check_magnitudes(const SceneDocument& document) {
  Diagnostics errors;
  for (const std::string& key : scene_keys()) {
    const auto found = document.largest.find(key);
    if (found == document.largest.end() || found->second.size <= ir::largest_of(document.scene.scalar)) continue;
    const auto& [size, text, entry, place] = found->second;
    add_error(errors,
              {Severity::error, place.file, place.element,
               fmt::format("the number {}{} is larger in size than {}", text,
                           entry.empty() ? "" : fmt::format(" of '{}'", entry), ir::largest_in_words(document.scene.scalar)),
               "correct the number: lengths are m, masses kg, angles rad"});
  }
  if (!errors.empty()) throw InputError(errors);
}

void read_file(SceneDocument& document, const std::string& file, const std::string& text) {
  std::optional<YamlNode> root;
  try {
    root = read_yaml(as_utf8(text));
  } catch (const YamlError& error) {
    const bool is_yaml = !error.remedy.empty();
    throw InputError({Severity::error, file, fmt::format("line {}, column {}", error.line, error.column),
                      (is_yaml ? "" : "this is not YAML: ") + std::string(error.what()),
                      is_yaml ? error.remedy : "share/doc/dalembert/docs/scene.md shows how a scene is written"});
  }
  if (!root) return;
  SceneKeys reader(document, file);
  if (!root->is_map())
    throw InputError({Severity::error, file, fmt::format("line {}, column {}", root->line, root->column),
                      "a scene is a map of keys to values", "write lines such as 'base: fixed'"});
  for (const auto& entry : root->entries) {
    const std::string key = entry.key.is_scalar() ? entry.key.scalar : "";
    const bool twice = document.given.count(key) > 0;
    reader.read(key, entry.key, entry.value);
    if (twice) reader.refuse(entry.key, "the key is given twice", "keep one of them");
  }
}

}  // namespace

const std::vector<std::string>& scene_keys() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> names;
    for (const SceneKeys::Key& key : SceneKeys::keys()) names.emplace_back(key.name);
    return names;
  }();
  return names;
}

SceneDocument read_scene(const std::string& file, const std::vector<Setting>& settings) {
  return read_scene_text(file, file.empty() ? "" : read_text_file(file, "scene", yaml_bytes), settings);
}

SceneDocument read_scene_text(const std::string& file, const std::string& text, const std::vector<Setting>& settings) {
  SceneDocument document;
  if (!file.empty()) read_file(document, file, text);
  for (const Setting& setting : settings) {
    YamlNode value;
    try {
      value = node_of(setting.text);
    } catch (const YamlError& error) {
      const bool is_yaml = !error.remedy.empty();
      throw InputError({Severity::error, "", "option --" + setting.key,
                        (is_yaml ? "" : "the value is not YAML: ") + std::string(error.what()),
                        is_yaml ? error.remedy : "share/doc/dalembert/docs/scene.md shows how it is written"});
    }
    SceneKeys(document, "").read(setting.key, scalar_node(setting.key), value);
  }
  check_magnitudes(document);
  return document;
}

}  // namespace dalembert::frontend
