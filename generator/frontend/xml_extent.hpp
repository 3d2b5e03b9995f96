// How deep and how large a text is to TinyXML, found out without its recursion.
//
// TinyXML calls itself for every level of nesting, compares every attribute of an element with those before it, reads beyond
// the end of a text that breaks off inside a UTF-8 character, and stops at a zero byte without a word. It also reads malformed
// XML in ways of its own: "&#x" hides all markup up to the next semicolon. So this walks through the text as TinyXML's parser
// does, step by step; tests/fuzz compares the two.
#pragma once

#include <stdexcept>
#include <string>

namespace dalembert::frontend {

struct XmlExtent {
  int depth = 0;       // elements inside each other
  int nodes = 0;       // elements, attributes, texts, comments and the like
  int attributes = 0;  // of the element that has most
};

// What TinyXML must not be given, and where.
struct XmlError : std::runtime_error {
  XmlError(const std::string& message, std::string remedy, size_t offset)
      : std::runtime_error(message), remedy(std::move(remedy)), offset(offset) {}
  std::string remedy;
  size_t offset;  // in bytes
};

// Of a text in UTF-8, up to the place where TinyXML stops because it is malformed. Throws XmlError at a zero byte, a character
// that is cut off by the end, and a reference that is malformed or to no character. Takes time in proportion to the text, and
// no memory.
XmlExtent xml_extent(const std::string& text);

}  // namespace dalembert::frontend
