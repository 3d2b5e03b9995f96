// The little JSON we write: strings escaped as RFC 8259 asks.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace dalembert {

// The text in quotes, with quotes, backslashes and control characters escaped. UTF-8 passes; a byte that is not UTF-8 becomes
// U+FFFD.
std::string json_string(std::string_view text);

// The text of a string that json_string wrote.
std::string text_of_json_string(std::string_view json);

// ["a", "b"]
std::string json_array(const std::vector<std::string>& texts);

}  // namespace dalembert
