#include "frontend/numbers.hpp"

#include <algorithm>
#include <charconv>

namespace dalembert::frontend {

namespace {
constexpr std::string_view blanks = " \t\r\n\f\v";

std::optional<double> parse_word(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);  // from_chars knows no plus sign
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::result_out_of_range) {  // below the smallest number is zero, above the largest is malformed
    if (word.find("e-") == word.npos && word.find("E-") == word.npos) return std::nullopt;
    return 0.0;
  }
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}
}  // namespace

std::optional<std::vector<double>> parse_numbers(std::string_view text) {
  std::vector<double> numbers;
  while (true) {
    const size_t begin = text.find_first_not_of(blanks);
    if (begin == text.npos) return numbers;
    text.remove_prefix(begin);
    const size_t length = std::min(text.find_first_of(blanks), text.size());
    const std::optional<double> number = parse_word(text.substr(0, length));
    if (!number) return std::nullopt;
    numbers.push_back(*number);
    text.remove_prefix(length);
  }
}

std::optional<double> parse_number(std::string_view text) {
  const std::optional<std::vector<double>> numbers = parse_numbers(text);
  if (!numbers || numbers->size() != 1) return std::nullopt;
  return numbers->front();
}

}  // namespace dalembert::frontend
