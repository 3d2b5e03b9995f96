// Text files of any encoding as UTF-8.
#pragma once

#include <string>

namespace dalembert::frontend {

// The text in UTF-8 without a byte order mark. UTF-16 is known by its mark; what is not UTF-8 either is taken for ISO 8859-1,
// of which every byte is a character: the XML parser would skip the quote behind an accented letter.
std::string as_utf8(const std::string& text);

}  // namespace dalembert::frontend
