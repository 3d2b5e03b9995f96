#include "frontend/text_encoding.hpp"

#include <cstdint>
#include <string_view>

namespace dalembert::frontend {

namespace {

// Behind the mark; half of a pair without the other is kept as it is.
std::string from_utf16(std::string_view text, bool big_endian) {
  std::string utf8;
  const auto unit = [&](size_t at) -> std::uint32_t {
    const auto byte = [&](size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])); };
    return big_endian ? byte(at) << 8 | byte(at + 1) : byte(at + 1) << 8 | byte(at);
  };
  for (size_t at = 0; at + 1 < text.size(); at += 2) {
    std::uint32_t code = unit(at);
    if (code >= 0xd800 && code < 0xdc00 && at + 3 < text.size()) {
      const std::uint32_t low = unit(at + 2);
      if (low >= 0xdc00 && low < 0xe000) {
        code = 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00);
        at += 2;
      }
    }
    append_utf8(utf8, code);
  }
  return utf8;
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const size_t length = utf8_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

}  // namespace

void append_utf8(std::string& utf8, std::uint32_t code) {
  const auto tail = [&](int shift) { utf8 += static_cast<char>(0x80 | ((code >> shift) & 0x3f)); };
  if (code < 0x80) {
    utf8 += static_cast<char>(code);
  } else if (code < 0x800) {
    utf8 += static_cast<char>(0xc0 | (code >> 6));
    tail(0);
  } else if (code < 0x10000) {
    utf8 += static_cast<char>(0xe0 | (code >> 12));
    tail(6);
    tail(0);
  } else {
    utf8 += static_cast<char>(0xf0 | (code >> 18));
    tail(12);
    tail(6);
    tail(0);
  }
}

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

std::string as_utf8(const std::string& text) {
  std::string_view view = text;
  if (view.starts_with("\xef\xbb\xbf")) view.remove_prefix(3);
  if (view.starts_with("\xff\xfe")) return from_utf16(view.substr(2), false);
  if (view.starts_with("\xfe\xff")) return from_utf16(view.substr(2), true);
  if (is_utf8(view)) return std::string(view);
  std::string utf8;
  for (char c : view) append_utf8(utf8, static_cast<unsigned char>(c));
  return utf8;
}

}  // namespace dalembert::frontend
