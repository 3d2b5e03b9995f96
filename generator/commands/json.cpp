#include "commands/json.hpp"

#include <fmt/format.h>

#include <cstdlib>

#include "frontend/text_encoding.hpp"

namespace dalembert {

std::string json_string(std::string_view text) {
  std::string json = "\"";
  while (!text.empty()) {
    const size_t length = frontend::utf8_length(text);
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
