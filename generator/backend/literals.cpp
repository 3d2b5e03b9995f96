#include "backend/literals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnostics.hpp"

namespace dalembert::backend {

std::string literal(double value, ir::ScalarType scalar) {
  const bool single = scalar == ir::ScalarType::float32;
  if (!(single ? std::isfinite(static_cast<float>(value)) : std::isfinite(value)))
    throw InputError({Severity::error, "", "the robot's constants",
                      fmt::format("a product of the robot's numbers is beyond the range of {}", single ? "float" : "double"),
                      "check the numbers of the URDF and the scene: lengths are m, masses kg"});
  std::string text = single ? fmt::format("{}", static_cast<float>(value)) : fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return single ? text + "f" : text;
}

std::string scalar_name(ir::ScalarType scalar) { return scalar == ir::ScalarType::float32 ? "float" : "double"; }

std::string wrapped(const std::vector<std::string>& items, int indent, int width) {
  std::string text;
  int column = indent;
  for (size_t i = 0; i < items.size(); ++i) {
    const std::string item = items[i] + (i + 1 < items.size() ? "," : "");
    const int length = static_cast<int>(item.size()) + 1;
    if (i > 0 && column + length > width) {
      text += "\n" + std::string(static_cast<size_t>(indent), ' ');
      column = indent;
    } else if (i > 0) {
      text += " ";
    }
    text += item;
    column += length;
  }
  return text;
}

std::string int_table(const std::string& name, const std::vector<int>& values) {
  std::vector<std::string> texts;
  for (int x : values) texts.push_back(std::to_string(x));
  return fmt::format("constexpr int {}[] = {{{}{}}};\n", name, texts.size() > 16 ? "\n    " : "", wrapped(texts, 4));
}

namespace {

// Whether a character that turns the direction of writing, U+202A to U+202E or U+2066 to U+2069, begins there: three bytes,
// with which text can look other than it is.
bool turns_writing(std::string_view text, size_t at) {
  const std::string_view bytes = text.substr(at, 3);
  return (bytes >= "\xe2\x80\xaa" && bytes <= "\xe2\x80\xae") || (bytes >= "\xe2\x81\xa6" && bytes <= "\xe2\x81\xa9");
}

}  // namespace

std::string quoted(std::string_view text) {
  std::string out = "\"";
  size_t escaped = 0;  // bytes before this one
  for (size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '"' || c == '\\' || (c == '?' && out.back() == '?')) out += '\\';  // "??/" would be a trigraph
    if (turns_writing(text, at)) escaped = at + 3;
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f || at < escaped) out += fmt::format("\\{:03o}", byte);
    else out += c;
  }
  return out + "\"";
}

std::string comment_text(std::string_view text) {
  std::string out;
  for (size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (turns_writing(text, at)) {
      at += 2;
      continue;
    }
    if (c == '?' && out.ends_with('?')) out += ' ';  // "??/" at the end of a line would continue it
    out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
  }
  while (!out.empty() && out.back() == '\\') out.pop_back();  // a comment line must not continue
  return out;
}

std::string comment_lines(std::string_view text, int indent, int hanging) {
  const std::string safe = comment_text(text), head = std::string(static_cast<size_t>(indent), ' ') + "//";
  std::string out, line = head;
  const auto finish = [&] {
    while (line.ends_with(' ') || line.ends_with('\\')) line.pop_back();  // it must not continue
    out += line + "\n";
  };
  bool any = false;
  const auto next_line = [&] {
    finish();
    line = head + std::string(static_cast<size_t>(hanging), ' ');
  };
  const size_t width = static_cast<size_t>(header_width);
  for (size_t at = 0; at < safe.size();) {
    const size_t end = std::min(safe.find(' ', at), safe.size());
    if (any && line.size() + 1 + end - at > width) next_line();
    line += ' ';
    // A list longer than a line is broken behind commas.
    while (line.size() + end - at > width) {
      const size_t comma = safe.rfind(',', at + width - line.size() - 1);
      if (comma == safe.npos || comma < at) break;
      line += safe.substr(at, comma + 1 - at);
      at = comma + 1;
      next_line();
      line += ' ';
    }
    line += safe.substr(at, end - at);
    any = true;
    at = end + 1;
  }
  finish();
  return out;
}

std::string with_comment(const std::string& code, std::string_view comment) {
  const std::string safe = comment_text(comment);
  if (code.size() + 5 + safe.size() <= static_cast<size_t>(header_width)) return code + "  // " + safe + "\n";
  return comment_lines(comment, static_cast<int>(code.find_first_not_of(' '))) + code + "\n";
}

}  // namespace dalembert::backend
