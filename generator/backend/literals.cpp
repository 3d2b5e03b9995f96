#include "backend/literals.hpp"

#include <fmt/format.h>

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

std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\' || (c == '?' && out.back() == '?')) out += '\\';  // "??/" would be a trigraph
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f) out += fmt::format("\\{:03o}", byte);
    else out += c;
  }
  return out + "\"";
}

std::string comment_text(std::string_view text) {
  std::string out;
  for (const char c : text) out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
  while (!out.empty() && out.back() == '\\') out.pop_back();  // a comment line must not continue
  return out;
}

}  // namespace dalembert::backend
