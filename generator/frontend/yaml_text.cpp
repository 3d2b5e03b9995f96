#include "frontend/yaml_text.hpp"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <map>
#include <sstream>
#include <utility>

namespace dalembert::frontend {

namespace {

// Builds the tree from yaml-cpp's events. Tags say nothing a scene could use.
class TreeBuilder : public YAML::EventHandler {
 public:
  std::optional<YamlNode> root;

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (mark.pos <= document_at_) fail(mark, "a value was expected", "");  // the last document has read nothing
    document_at_ = mark.pos;
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    if (!open_.empty()) close(begun(mark, YamlNode::Kind::null), anchor);
  }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor, const std::string& text) override {
    YamlNode node = begun(mark, YamlNode::Kind::scalar);
    node.scalar = text;
    close(std::move(node), anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchors_.find(anchor);
    if (found == anchors_.end()) fail(mark, "the alias stands inside the value it repeats", "write the value out");
    count(mark, size(found->second) - 1);
    begun(mark, YamlNode::Kind::null);
    close(found->second, YAML::NullAnchor);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor, YAML::EmitterStyle::value) override {
    open(mark, YamlNode::Kind::sequence, anchor);
  }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor, YAML::EmitterStyle::value) override {
    open(mark, YamlNode::Kind::map, anchor);
  }
  void OnSequenceEnd() override { close_collection(); }
  void OnMapEnd() override { close_collection(); }

 private:
  struct Open {
    YamlNode node;
    YAML::anchor_t anchor;
    std::optional<YamlNode> key;  // of a map: waits for its value
  };

  [[noreturn]] static void fail(const YAML::Mark& mark, const std::string& message, std::string remedy) {
    throw YamlError(message, std::move(remedy), mark.line + 1, mark.column + 1);
  }

  void count(const YAML::Mark& mark, int more) {
    values_ += more;
    if (values_ > yaml_values)
      fail(mark, fmt::format("there are more than {} values", yaml_values), "leave out what is not needed");
  }

  YamlNode begun(const YAML::Mark& mark, YamlNode::Kind kind) {
    count(mark, 1);
    if (open_.empty() && root)
      fail(mark, "a second document begins here", "a scene is one document: remove the line '---' and what is not needed");
    YamlNode node;
    node.kind = kind;
    node.line = mark.line + 1;
    node.column = mark.column + 1;
    return node;
  }

  void open(const YAML::Mark& mark, YamlNode::Kind kind, YAML::anchor_t anchor) {
    if (open_.size() == yaml_depth)
      fail(mark, fmt::format("lists and maps are nested more than {} deep", yaml_depth), "a scene needs six levels");
    open_.push_back({begun(mark, kind), anchor, std::nullopt});
  }

  void close_collection() {
    Open done = std::move(open_.back());
    open_.pop_back();
    close(std::move(done.node), done.anchor);
  }

  // The node is complete: it goes where it belongs.
  void close(YamlNode node, YAML::anchor_t anchor) {
    if (anchor != YAML::NullAnchor) anchors_[anchor] = node;
    if (open_.empty()) root = std::move(node);
    else if (Open& above = open_.back(); above.node.is_sequence()) above.node.items.push_back(std::move(node));
    else if (!above.key && node.is_scalar() && node.scalar == "<<")
      throw YamlError("merge keys (<<) are not read", "write the entries out; aliases of whole values are read", node.line,
                      node.column);
    else if (!above.key) above.key = std::move(node);
    else above.node.entries.push_back({std::move(*std::exchange(above.key, std::nullopt)), std::move(node)});
  }

  // In values; a long text counts as several, since an alias copies it.
  static int size(const YamlNode& node) {
    int sum = 1 + static_cast<int>(node.scalar.size() / 32);
    for (const YamlNode& item : node.items) sum += size(item);
    for (const auto& [key, value] : node.entries) sum += size(key) + size(value);
    return sum;
  }

  std::vector<Open> open_;  // the lists and maps around the next value
  std::map<YAML::anchor_t, YamlNode> anchors_;
  int values_ = 0;
  int document_at_ = -1;
};

// A control character ends yaml-cpp's input in silence (4), or a name in C (0).
void refuse_control_characters(const std::string& text) {
  int line = 1;
  size_t begin = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    const unsigned char byte = static_cast<unsigned char>(text[i]);
    if (byte == '\n') {
      ++line;
      begin = i + 1;
    } else if (byte < 0x20 && byte != '\t' && byte != '\r') {
      throw YamlError(fmt::format("byte {} is a control character", byte), "save the file as text in UTF-8", line,
                      static_cast<int>(i - begin) + 1);
    }
  }
}

}  // namespace

YamlNode scalar_node(std::string text) {
  YamlNode node;
  node.kind = YamlNode::Kind::scalar;
  node.scalar = std::move(text);
  return node;
}

YamlNode sequence_node(const std::vector<std::string>& texts) {
  YamlNode node;
  node.kind = YamlNode::Kind::sequence;
  for (const std::string& text : texts) node.items.push_back(scalar_node(text));
  return node;
}

std::optional<YamlNode> read_yaml(const std::string& text) {
  if (text.size() > yaml_bytes)
    throw YamlError(fmt::format("the text is longer than {} MiB", yaml_bytes >> 20), "leave out what is not needed", 1, 1);
  refuse_control_characters(text);
  std::istringstream stream(text);
  TreeBuilder builder;
  try {
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) continue;
  } catch (const YAML::Exception& error) {
    throw YamlError(error.msg, "", error.mark.line + 1, error.mark.column + 1);
  }
  return std::move(builder.root);
}

}  // namespace dalembert::frontend
