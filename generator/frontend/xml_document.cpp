#include "frontend/xml_document.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "diagnostics.hpp"
#include "frontend/xml_extent.hpp"

namespace dalembert::frontend {

namespace {

void check_limits(const std::string& file, const std::string& text) {
  const auto refuse = [&](std::string message, std::string remedy) -> void {
    throw InputError({Severity::error, file, "", std::move(message), std::move(remedy)});
  };
  const std::string remedy = "leave out what is not needed: the dynamics read links, joints and inertias";
  if (text.size() > xml_bytes) refuse(fmt::format("the file is longer than {} MiB", xml_bytes >> 20), remedy);
  const XmlExtent extent = xml_extent(text);
  if (extent.depth > xml_depth)
    refuse(fmt::format("elements are nested {} deep; no more than {} are allowed", extent.depth, xml_depth),
           "close elements before the next begins; a robot's links and joints stand side by side");
  if (extent.attributes > xml_attributes)
    refuse(fmt::format("an element has {} attributes; no more than {} are allowed", extent.attributes, xml_attributes), remedy);
  if (extent.nodes > xml_nodes)
    refuse(fmt::format("there are {} elements, attributes and texts; no more than {} are allowed", extent.nodes, xml_nodes),
           remedy);
}

}  // namespace

size_t parse_xml(TiXmlDocument& document, const std::string& file, const std::string& text) {
  try {
    check_limits(file, text);
  } catch (const XmlError& error) {
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(error.offset), '\n');
    throw InputError({Severity::error, file, fmt::format("line {}", line), error.what(), error.remedy});
  }
  const char* end = document.Parse(text.c_str(), nullptr, TIXML_ENCODING_UTF8);
  return end ? static_cast<size_t>(end - text.c_str()) : text.size();
}

}  // namespace dalembert::frontend
