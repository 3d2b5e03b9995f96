// Numbers and names as C++ text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ir/scene.hpp"

namespace dalembert::backend {

// A literal of the scene's scalar type that reads back as the same value: `0.5`, `1e-09`, `0.5f`. Throws InputError where the
// type has no such number: products of a robot's numbers can be infinite though none of them is large (passes/magnitudes.hpp).
std::string literal(double value, ir::ScalarType scalar);

// `double` or `float`.
std::string scalar_name(ir::ScalarType scalar);

// Items joined by ", " and broken into lines of at most `width` characters, each but the first indented by `indent` blanks.
std::string wrapped(const std::vector<std::string>& items, int indent, int width = 118);

// The definition of a constant table.
std::string int_table(const std::string& name, const std::vector<int>& values);

// A C string literal, quotes included.
std::string quoted(std::string_view text);

// A text safe inside a // comment: one line, printable.
std::string comment_text(std::string_view text);

// The letters that a line of a generated header holds, and a comment of such lines: `text` as // lines behind `indent` blanks,
// broken at its blanks (a word longer than a line: behind commas), those after the first set in by `hanging` more.
inline constexpr int header_width = 120;
std::string comment_lines(std::string_view text, int indent = 0, int hanging = 0);

// A line of code and a comment: beside it where both fit a line, else above it. Ends its line.
std::string with_comment(const std::string& code, std::string_view comment);

}  // namespace dalembert::backend
