// A YAML text as a tree of values with their places. Nothing else includes yaml-cpp.
//
// yaml-cpp is asked for its events, one document after another, and never for its own tree: of a text whose next token cannot
// begin a value, such as ", b", it makes empty documents for ever. Here a document that begins where the one before it began
// ends the reading, and the limits below hold while the text is read, not after.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace dalembert::frontend {

struct YamlEntry;

struct YamlNode {
  enum class Kind { null, scalar, sequence, map };
  Kind kind = Kind::null;
  std::string scalar;
  std::vector<YamlNode> items;     // of a sequence
  std::vector<YamlEntry> entries;  // of a map, in the text's order; a key may stand twice
  int line = 1, column = 1;

  bool is_scalar() const { return kind == Kind::scalar; }
  bool is_sequence() const { return kind == Kind::sequence; }
  bool is_map() const { return kind == Kind::map; }
};

struct YamlEntry {
  YamlNode key, value;
};

YamlNode scalar_node(std::string text);
YamlNode sequence_node(const std::vector<std::string>& texts);

// What is allowed; ten times as much as the scene of a robot with a thousand joints needs.
inline constexpr size_t yaml_bytes = size_t{4} << 20;
inline constexpr int yaml_values = 200'000;  // keys and what aliases repeat included
inline constexpr int yaml_depth = 16;        // lists and maps inside each other

// Why a text cannot be read, and where.
struct YamlError : std::runtime_error {
  YamlError(const std::string& message, std::string remedy, int line, int column)
      : std::runtime_error(message), remedy(std::move(remedy)), line(line), column(column) {}
  std::string remedy;  // empty: the text is no YAML
  int line, column;
};

// The one value of the text; nothing when there is none. Throws YamlError when the text is no YAML, exceeds a limit, holds
// control characters or a second value. Takes time in proportion to the text, whatever it holds.
std::optional<YamlNode> read_yaml(const std::string& text);

}  // namespace dalembert::frontend
