#include "frontend/numbers.hpp"

#include <algorithm>
#include <charconv>

namespace dalembert::frontend {

namespace {
constexpr std::string_view blanks = " \t\r\n\f\v";

// Whether a decimal number that no double can hold is too small rather than too large: its first significant digit stands
// behind the decimal point.
bool is_tiny(std::string_view number) {
  const size_t exponent_at = std::min(number.find_first_of("eE"), number.size());
  const std::string_view digits = number.substr(0, exponent_at);
  const size_t first = digits.find_first_of("123456789"), point = std::min(digits.find('.'), digits.size());
  const bool in_front = first < point;
  const long order = in_front ? static_cast<long>(point - first) : -static_cast<long>(first - point);
  if (exponent_at == number.size()) return order < 0;
  std::string_view text = number.substr(exponent_at + 1);
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  long exponent = 0;
  if (std::from_chars(text.data(), text.data() + text.size(), exponent).ec != std::errc())
    return negative;  // beyond all bounds
  return (negative ? -exponent : exponent) + order < 0;
}

std::optional<double> parse_word(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);  // from_chars knows no plus sign
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size()) return std::nullopt;
  if (error == std::errc::result_out_of_range)  // below the smallest number is zero, above the largest is malformed
    return is_tiny(word) ? std::optional<double>(0.0) : std::nullopt;
  if (error != std::errc()) return std::nullopt;
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

std::string_view trimmed(std::string_view text) {
  const size_t begin = text.find_first_not_of(blanks);
  if (begin == text.npos) return {};
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

std::optional<double> parse_number(std::string_view text) {
  const std::optional<std::vector<double>> numbers = parse_numbers(text);
  if (!numbers || numbers->size() != 1) return std::nullopt;
  return numbers->front();
}

}  // namespace dalembert::frontend
