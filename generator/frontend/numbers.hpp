// Numbers in text, read the same way in every locale.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace dalembert::frontend {

// The whole text (blanks around it aside) as one number; nothing when it is not one. Reads "nan" and "inf": callers that
// want finite numbers check.
std::optional<double> parse_number(std::string_view text);

// Numbers separated by blanks; nothing when one of them is malformed.
std::optional<std::vector<double>> parse_numbers(std::string_view text);

}  // namespace dalembert::frontend
