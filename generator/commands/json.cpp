#include "commands/json.hpp"

#include <fmt/format.h>

#include <cstdlib>

namespace dalembert {

namespace {

// Bytes of the well-formed UTF-8 sequence at the start of the text; 0 when it is not one.
size_t utf8_length(std::string_view text) {
  const auto byte = [&](size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  const size_t length = first < 0x80 ? 1 : first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : first < 0xF5 ? 4 : 0;
  if (length == 0 || length > text.size()) return 0;
  for (size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  const bool overlong = (first == 0xE0 && byte(1) < 0xA0) || (first == 0xF0 && byte(1) < 0x90);
  const bool not_a_character = (first == 0xED && byte(1) >= 0xA0) || (first == 0xF4 && byte(1) >= 0x90);
  return overlong || not_a_character ? 0 : length;
}

}  // namespace

std::string json_string(std::string_view text) {
  std::string json = "\"";
  while (!text.empty()) {
    const size_t length = utf8_length(text);
    const char c = text.front();
    if (length == 0) json += "\\ufffd";
    else if (c == '"' || c == '\\') json += {'\\', c};
    else if (static_cast<unsigned char>(c) < 0x20) json += fmt::format("\\u{:04x}", static_cast<int>(c));
    else json += text.substr(0, length);
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return json + '"';
}

std::string text_of_json_string(std::string_view json) {
  json.remove_prefix(1);
  std::string text;
  while (json.size() > 1) {
    size_t length = 1;
    if (json.front() != '\\') text += json.front();
    else if (json[1] != 'u') text += json[1], length = 2;
    else {
      const std::string digits(json.substr(2, 4));
      length = 6;
      text += digits == "fffd" ? "\xef\xbf\xbd" : std::string(1, static_cast<char>(std::strtol(digits.c_str(), nullptr, 16)));
    }
    json.remove_prefix(length);
  }
  return text;
}

std::string json_array(const std::vector<std::string>& texts) {
  std::string json = "[";
  for (const std::string& text : texts) {
    if (json.size() > 1) json += ", ";
    json += json_string(text);
  }
  return json + "]";
}

}  // namespace dalembert
