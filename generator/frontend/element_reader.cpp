#include "frontend/element_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "frontend/numbers.hpp"

namespace dalembert::frontend {

namespace {
bool is_in(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string number_remedy(std::string_view text) {
  return text.find("${") != text.npos ? "expand the file with xacro first"
                                      : "write finite decimal numbers such as 0.25 or 1e-3";
}
}  // namespace

void ElementReader::error(const TiXmlElement& at, std::string message, std::string remedy) {
  add_error(errors_,
            {Severity::error, file_, fmt::format("{} (line {})", owner_, at.Row()), std::move(message), std::move(remedy)});
}

void ElementReader::warning(const TiXmlElement& at, std::string message, std::string remedy) {
  warnings_.push_back(
      {Severity::warning, file_, fmt::format("{} (line {})", owner_, at.Row()), std::move(message), std::move(remedy)});
}

std::optional<std::string> ElementReader::required(const TiXmlElement& element, const char* attribute,
                                                   const std::string& remedy) {
  const char* text = element.Attribute(attribute);
  if (text && std::string_view(text).find_first_not_of(" \t\r\n") != std::string_view::npos) return text;
  error(element, fmt::format("<{}> has no {}", element.Value(), attribute), remedy);
  return std::nullopt;
}

std::optional<double> ElementReader::number(const TiXmlElement& element, const char* attribute) {
  const char* text = element.Attribute(attribute);
  if (!text) return std::nullopt;
  const std::optional<double> value = parse_number(text);
  if (value && std::isfinite(*value)) return value;
  error(element,
        fmt::format("<{} {}=\"{}\"> is not a {}", element.Value(), attribute, text, value ? "finite number" : "number"),
        number_remedy(text));
  return std::nullopt;
}

std::optional<Eigen::Vector3d> ElementReader::vector(const TiXmlElement& element, const char* attribute) {
  const char* text = element.Attribute(attribute);
  if (!text) return std::nullopt;
  const std::optional<std::vector<double>> values = parse_numbers(text);
  if (values && values->size() == 3 && std::all_of(values->begin(), values->end(), [](double x) { return std::isfinite(x); }))
    return Eigen::Vector3d((*values)[0], (*values)[1], (*values)[2]);
  error(element, fmt::format("<{} {}=\"{}\"> is not three finite numbers", element.Value(), attribute, text),
        number_remedy(text));
  return std::nullopt;
}

void ElementReader::only_attributes(const TiXmlElement& element, std::initializer_list<std::string_view> known) {
  for (const TiXmlAttribute* a = element.FirstAttribute(); a; a = a->Next())
    if (!is_in(a->Name(), known))
      warning(element, fmt::format("unknown attribute '{}' of <{}> is ignored", a->Name(), element.Value()),
              fmt::format("the known ones are {}", fmt::join(known, ", ")));
}

void ElementReader::only_children(const TiXmlElement& element, std::initializer_list<std::string_view> once,
                                  std::initializer_list<std::string_view> any_number) {
  std::vector<std::string_view> known(once);
  known.insert(known.end(), any_number);
  std::set<std::string_view> seen;
  for (const TiXmlElement* child = element.FirstChildElement(); child; child = child->NextSiblingElement()) {
    const std::string_view tag = child->Value();
    if (is_in(tag, any_number) || tag.find(':') != tag.npos) continue;  // a prefix: somebody else's extension
    if (!is_in(tag, once))
      warning(*child, fmt::format("unknown element <{}> in <{}> is ignored", tag, element.Value()),
              fmt::format("the known ones are {}", fmt::join(known, ", ")));
    else if (!seen.insert(tag).second)
      warning(*child, fmt::format("a second <{}> in <{}> is ignored", tag, element.Value()), "keep one of them");
  }
}

}  // namespace dalembert::frontend
