#include "frontend/setting_text.hpp"

#include <string_view>
#include <vector>

#include "frontend/numbers.hpp"

namespace dalembert::frontend {

namespace {

std::vector<std::string> split(std::string_view text) {
  std::vector<std::string> pieces;
  while (true) {
    const size_t comma = text.find(',');
    pieces.emplace_back(trimmed(text.substr(0, comma)));
    if (comma == text.npos) return pieces;
    text.remove_prefix(comma + 1);
  }
}

}  // namespace

YamlNode node_of(const std::string& text) {
  const std::string value(trimmed(text));
  if (value.starts_with('[') || value.starts_with('{')) return read_yaml(value).value_or(YamlNode());
  if (value.empty()) return sequence_node({});
  const std::vector<std::string> pieces = split(value);
  if (value.find('=') == value.npos) return pieces.size() == 1 ? scalar_node(value) : sequence_node(pieces);
  // A piece without '=' continues the value before it.
  std::vector<std::pair<std::string, std::vector<std::string>>> entries;
  for (const std::string& piece : pieces) {
    const size_t equals = piece.find('=');
    const std::string_view view = piece;
    if (equals != piece.npos)
      entries.push_back({std::string(trimmed(view.substr(0, equals))), {std::string(trimmed(view.substr(equals + 1)))}});
    else if (entries.empty()) return sequence_node(pieces);
    else entries.back().second.push_back(piece);
  }
  YamlNode map;
  map.kind = YamlNode::Kind::map;
  for (const auto& [key, values] : entries)
    map.entries.push_back({scalar_node(key), values.size() == 1 ? scalar_node(values.front()) : sequence_node(values)});
  return map;
}

}  // namespace dalembert::frontend
