// Numbers in text, read the same way in every locale. What is read here is what the robot gets: nobody else reads numbers.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace dalembert::frontend {

// The text without the blanks, tabs and line ends around it.
std::string_view trimmed(std::string_view text);

// The whole text (blanks around it aside) as one number; nothing when it is not one. Reads "nan" and "inf": callers that
// want finite numbers check. "+1", ".5", "5." and "1E-3" are numbers; "1e-3f", "0x10", "1,5" and "1 kg" are not. What is
// too small for a double is zero, what is too large is none.
std::optional<double> parse_number(std::string_view text);

// Numbers separated by blanks; nothing when one of them is malformed.
std::optional<std::vector<double>> parse_numbers(std::string_view text);

}  // namespace dalembert::frontend
