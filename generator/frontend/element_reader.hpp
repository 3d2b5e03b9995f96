// One XML element read with complaints: attributes, numbers and children, each defect a diagnostic with the line.
#pragma once

#include <tinyxml.h>

#include <Eigen/Core>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "diagnostics.hpp"

namespace dalembert::frontend {

// The beginning of a text, for messages.
std::string excerpt(std::string_view text);

// Where complaints about one link or joint go.
class ElementReader {
 public:
  ElementReader(std::string file, Diagnostics& errors, Diagnostics& warnings)
      : file_(std::move(file)), errors_(errors), warnings_(warnings) {}

  // Every complaint from here on is about this element: "joint 'l_knee'"; the line is that of the XML element at fault.
  void enter(std::string owner) { owner_ = std::move(owner); }

  void error(const TiXmlElement& at, std::string message, std::string remedy);
  // `kind`: as in Diagnostic.
  void warning(const TiXmlBase& at, std::string message, std::string remedy, std::string kind = "");

  // The attribute's text without the blanks around it; an error when it is missing or blank.
  std::optional<std::string> required(const TiXmlElement& element, const char* attribute, const std::string& remedy);
  // The attribute as a finite number, or three of them; nothing (and an error, if it is there but malformed) otherwise.
  std::optional<double> number(const TiXmlElement& element, const char* attribute);
  std::optional<Eigen::Vector3d> vector(const TiXmlElement& element, const char* attribute);
  // A number that the dynamics need not read, such as a limit: a warning instead, and NaN.
  std::optional<double> optional_number(const TiXmlElement& element, const char* attribute);

  // Warns about attributes and children that are not in the lists, and about a second child of the same `once` name, and
  // about text between the children. Names with a prefix are somebody else's extension.
  void only_attributes(const TiXmlElement& element, std::initializer_list<std::string_view> known);
  void only_children(const TiXmlElement& element, std::initializer_list<std::string_view> once,
                     std::initializer_list<std::string_view> any_number);
  // For elements whose data are attributes: complains of text and elements between the tags, which nobody reads. Where there
  // are no attributes this is an error, and false is returned. Elements with a prefix are somebody else's extension.
  bool data_in_attributes(const TiXmlElement& element, const std::string& remedy);

  // Whether the file has macros of xacro or includes them. Without, nobody can expand a call of one: it is ignored with a
  // warning.
  void has_macros(bool has) { has_macros_ = has; }
  // Whether this is such a call.
  bool is_lost_call(std::string_view tag) const;

  // What xacro has not expanded: places where the robot is not what the file says. Definitions alone do not count.
  void note_xacro(const TiXmlElement& at, std::string what);
  // One error that stands for all of them, if there are any.
  std::optional<Diagnostic> unexpanded_xacro() const;

 private:
  std::string file_;
  Diagnostics& errors_;
  Diagnostics& warnings_;
  std::string owner_;
  std::string first_xacro_;  // its place
  std::string what_xacro_;
  int xacros_ = 0;
  bool has_macros_ = false;
};

}  // namespace dalembert::frontend
