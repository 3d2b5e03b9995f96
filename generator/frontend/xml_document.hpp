// A URDF's text as an XML document, within limits.
#pragma once

#include <tinyxml.h>

#include <string>

namespace dalembert::frontend {

// What is allowed: far more than a robot needs, and little enough for TinyXML's stack and for memory.
inline constexpr size_t xml_bytes = size_t{64} << 20;
inline constexpr int xml_depth = 100;        // elements inside each other
inline constexpr int xml_nodes = 8'000'000;  // elements, attributes, texts, comments
inline constexpr int xml_attributes = 100;   // of one element

// Parses a text in UTF-8; malformed XML is left in document.Error(). Returns where the reading ended: TinyXML stops without a
// word at text that stands outside of all elements. `file` is for the diagnostics. Throws InputError when a
// limit is exceeded, and where TinyXML would not see the text that is there.
size_t parse_xml(TiXmlDocument& document, const std::string& file, const std::string& text);

}  // namespace dalembert::frontend
