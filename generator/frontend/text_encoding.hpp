// Text files of any encoding as UTF-8.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace dalembert::frontend {

// The text in UTF-8 without a byte order mark. UTF-16 is known by its mark; what is not UTF-8 either is taken for ISO 8859-1,
// of which every byte is a character: the XML parser would skip the quote behind an accented letter.
std::string as_utf8(const std::string& text);

// Appends the character of that number.
void append_utf8(std::string& utf8, std::uint32_t code);

// Bytes of the well-formed UTF-8 sequence at the start of a text that is not empty; 0 where there is none.
std::size_t utf8_length(std::string_view text);

}  // namespace dalembert::frontend
