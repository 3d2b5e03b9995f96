#include "frontend/element_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "frontend/numbers.hpp"

namespace dalembert::frontend {

namespace {
bool is_in(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool is_xacro_expression(std::string_view text) { return text.find("${") != text.npos || text.find("$(") != text.npos; }

constexpr const char* number_remedy = "write finite decimal numbers such as 0.25 or 1e-3";

template <class Names>
std::string known_names(const Names& names) {
  return names.size() == 0 ? "remove it" : fmt::format("the known ones are {}", fmt::join(names, ", "));
}

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
}
}  // namespace

std::string excerpt(std::string_view text) {
  constexpr size_t most = 40;
  text = trimmed(text);
  size_t end = std::min(text.find_first_of("\r\n"), text.size());
  if (end > most)
    for (end = most; end > 0 && (text[end] & 0xc0) == 0x80;) --end;  // not inside a character
  return std::string(text.substr(0, end)) + (end < text.size() ? "..." : "");
}

void ElementReader::error(const TiXmlElement& at, std::string message, std::string remedy) {
  add_error(errors_,
            {Severity::error, file_, fmt::format("{} (line {})", owner_, at.Row()), std::move(message), std::move(remedy)});
}

void ElementReader::warning(const TiXmlBase& at, std::string message, std::string remedy, std::string kind) {
  warnings_.push_back({Severity::warning, file_, fmt::format("{} (line {})", owner_, at.Row()), std::move(message),
                       std::move(remedy), std::move(kind)});
}

std::optional<std::string> ElementReader::required(const TiXmlElement& element, const char* attribute,
                                                   const std::string& remedy) {
  const char* text = element.Attribute(attribute);
  if (text && is_xacro_expression(text)) note_xacro(element, fmt::format("<{} {}=\"{}\">", element.Value(), attribute, text));
  if (text && !trimmed(text).empty()) return std::string(trimmed(text));
  error(element, fmt::format("<{}> has no {}", element.Value(), attribute), remedy);
  return std::nullopt;
}

std::optional<double> ElementReader::number(const TiXmlElement& element, const char* attribute) {
  const char* text = element.Attribute(attribute);
  if (!text) return std::nullopt;
  const std::optional<double> value = parse_number(text);
  if (value && std::isfinite(*value)) return value;
  const std::string written = fmt::format("<{} {}=\"{}\">", element.Value(), attribute, text);
  if (is_xacro_expression(text)) note_xacro(element, written);
  else error(element, fmt::format("{} is not a {}", written, value ? "finite number" : "number"), number_remedy);
  return std::nullopt;
}

std::optional<Eigen::Vector3d> ElementReader::vector(const TiXmlElement& element, const char* attribute) {
  const char* text = element.Attribute(attribute);
  if (!text) return std::nullopt;
  const std::optional<std::vector<double>> values = parse_numbers(text);
  if (values && values->size() == 3 && all_finite(*values)) return Eigen::Vector3d((*values)[0], (*values)[1], (*values)[2]);
  const std::string written = fmt::format("<{} {}=\"{}\">", element.Value(), attribute, text);
  if (is_xacro_expression(text)) note_xacro(element, written);
  else
    error(element, fmt::format("{} is not three finite numbers", written),
          "write three finite decimal numbers with blanks between them");
  return std::nullopt;
}

std::optional<double> ElementReader::optional_number(const TiXmlElement& element, const char* attribute) {
  const char* text = element.Attribute(attribute);
  if (!text) return std::nullopt;
  if (const std::optional<double> value = parse_number(text); value && !std::isnan(*value)) return value;
  warning(element, fmt::format("<{} {}=\"{}\"> is not a number: it is not used", element.Value(), attribute, text),
          is_xacro_expression(text) ? "expand the file with ROS's xacro" : number_remedy,
          fmt::format("number {} {}", element.Value(), attribute));
  return std::numeric_limits<double>::quiet_NaN();
}

void ElementReader::only_attributes(const TiXmlElement& element, std::initializer_list<std::string_view> known) {
  for (const TiXmlAttribute* a = element.FirstAttribute(); a; a = a->Next())
    if (std::string_view(a->Name()).find(':') == std::string_view::npos && !is_in(a->Name(), known))
      warning(element, fmt::format("unknown attribute '{}' of <{}> is ignored", a->Name(), element.Value()),
              known_names(known));
}

void ElementReader::only_children(const TiXmlElement& element, std::initializer_list<std::string_view> once,
                                  std::initializer_list<std::string_view> any_number) {
  std::vector<std::string_view> known(once);
  known.insert(known.end(), any_number);
  for (const TiXmlNode* node = element.FirstChild(); node; node = node->NextSibling())
    if (node->ToText() && !trimmed(node->Value()).empty())
      warning(*node, fmt::format("the text '{}' in <{}> is ignored", excerpt(node->Value()), element.Value()),
              "remove it, or make it a comment: <!-- ... -->", fmt::format("text in {}", element.Value()));
  std::set<std::string_view> seen;
  for (const TiXmlElement* child = element.FirstChildElement(); child; child = child->NextSiblingElement()) {
    const std::string_view tag = child->Value();
    if (is_in(tag, any_number)) continue;
    if (is_lost_call(tag)) {
      warning(*child,
              fmt::format("<{}> in <{}> calls a macro that the file neither has nor includes, so that xacro cannot expand it: "
                          "it is ignored",
                          tag, element.Value()),
              "put what it stands for in its place, or remove it");
    } else if (tag.starts_with("xacro:") || tag == "include") {  // old files include without a prefix
      if (!is_in(tag, {"xacro:property", "xacro:arg", "xacro:macro"})) note_xacro(*child, fmt::format("<{}>", tag));
    } else if (const size_t prefix = tag.find(':'); prefix != tag.npos) {  // somebody else's extension
      if (is_in(tag.substr(prefix + 1), {"link", "joint"}))
        warning(*child, fmt::format("<{}> is no element of URDF and is ignored", tag),
                fmt::format("write a <{}> in its place where the dynamics needs it", tag.substr(prefix + 1)),
                fmt::format("element {}", tag));
    } else if (tag == "loop_joint") {  // Drake's of old
      warning(*child, "<loop_joint> is no element of URDF and is ignored: what it closes is open",
              "say in the scene what holds which links together: loops", "element loop_joint");
    } else if (!is_in(tag, once)) {
      warning(*child, fmt::format("unknown element <{}> in <{}> is ignored", tag, element.Value()), known_names(known));
    } else if (!seen.insert(tag).second) {
      warning(*child, fmt::format("a second <{}> in <{}> is ignored", tag, element.Value()), "keep one of them");
    }
  }
}

bool ElementReader::data_in_attributes(const TiXmlElement& element, const std::string& remedy) {
  for (const TiXmlNode* node = element.FirstChild(); node; node = node->NextSibling()) {
    const std::string_view value = node->Value();
    std::string found;
    if (node->ToText() && !trimmed(value).empty()) found = fmt::format("'{}'", excerpt(value));
    if (node->ToElement() && (value.find(':') == value.npos || value.starts_with("xacro:"))) found = fmt::format("<{}>", value);
    if (found.empty()) continue;
    const std::string fault = fmt::format("<{}> has {} between its tags, where nothing is read", element.Value(), found);
    if (value.starts_with("xacro:") || is_xacro_expression(value))
      note_xacro(element, fmt::format("{} in <{}>", found, element.Value()));
    else if (element.FirstAttribute()) warning(element, fault, "remove it");
    else error(element, fault, remedy);
    return element.FirstAttribute();
  }
  return true;
}

bool ElementReader::is_lost_call(std::string_view tag) const {
  constexpr std::string_view prefix = "xacro:";
  if (has_macros_ || !tag.starts_with(prefix)) return false;
  return !is_in(tag.substr(prefix.size()),
                {"include", "macro", "property", "arg", "if", "unless", "insert_block", "call", "element", "attribute"});
}

void ElementReader::note_xacro(const TiXmlElement& at, std::string what) {
  if (xacros_++ > 0) return;
  first_xacro_ = fmt::format("{} (line {})", owner_, at.Row());
  what_xacro_ = std::move(what);
}

std::optional<Diagnostic> ElementReader::unexpanded_xacro() const {
  if (xacros_ == 0) return std::nullopt;
  const std::string more = xacros_ > 1 ? fmt::format(", as in {} more place{}", xacros_ - 1, xacros_ > 2 ? "s" : "") : "";
  return Diagnostic{Severity::error, file_, first_xacro_,
                    fmt::format("{} is left for xacro to expand{}: the file does not yet describe a robot", what_xacro_, more),
                    fmt::format("expand it with ROS's xacro: xacro {} > expanded.urdf, and name that", file_)};
}

}  // namespace dalembert::frontend
