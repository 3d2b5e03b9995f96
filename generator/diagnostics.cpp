#include "diagnostics.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <map>
#include <utility>

namespace dalembert {

namespace {
// Of what compilers say, lines and tabs stay.
std::string without_control(const std::string& text) {
  std::string shown;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte < 0x20 && c != '\n' && c != '\t') || byte == 0x7f) shown += fmt::format("\\x{:02x}", byte);
    else shown += c;
  }
  return shown;
}
}  // namespace

std::string to_string(const Diagnostic& d) {
  std::string text;
  if (!d.file.empty()) text += d.file + ": ";
  if (!d.element.empty()) text += d.element + ": ";
  const char* names[] = {"notice", "warning", "error"};
  text += fmt::format("{}: {}", names[static_cast<int>(d.severity)], d.message);
  if (!d.remedy.empty()) text += "; " + d.remedy;
  return without_control(text);
}

void tell(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

std::vector<int> alike(const Diagnostics& diagnostics) {
  const auto kind = [](const Diagnostic& d) { return std::pair(d.file, d.kind.empty() ? d.message : d.kind); };
  std::map<std::pair<std::string, std::string>, int> count;
  for (const Diagnostic& d : diagnostics)
    if (d.severity == Severity::warning) ++count[kind(d)];
  std::vector<int> numbers;
  for (const Diagnostic& d : diagnostics)
    numbers.push_back(d.severity == Severity::warning ? std::exchange(count[kind(d)], 0) : 1);
  return numbers;
}

std::vector<std::string> lines(const Diagnostics& diagnostics, bool verbose) {
  const std::vector<int> such = alike(diagnostics);
  std::vector<std::string> lines;
  for (size_t i = 0; i < diagnostics.size(); ++i) {
    if (!verbose && such[i] == 0) continue;  // told with the first
    lines.push_back(to_string(diagnostics[i]));
    if (!verbose && such[i] > 1) lines.back() += fmt::format(" (the first of {} such warnings; --verbose shows all)", such[i]);
  }
  return lines;
}

namespace {
std::string join(const Diagnostics& diagnostics) {
  std::string text;
  for (const Diagnostic& d : diagnostics) {
    if (!text.empty()) text += '\n';
    text += to_string(d);
  }
  return text;
}
}  // namespace

InputError::InputError(Diagnostic diagnostic) : InputError(Diagnostics{std::move(diagnostic)}) {}

InputError::InputError(Diagnostics diagnostics) : std::runtime_error(join(diagnostics)), diagnostics_(std::move(diagnostics)) {}

void add_error(Diagnostics& errors, Diagnostic error) {
  constexpr size_t most = 100;
  errors.push_back(std::move(error));
  if (errors.size() < most) return;
  const std::string file = errors.back().file;
  errors.push_back(
      {Severity::error, file, "", fmt::format("these are the first {} errors", most), "correct them to see others"});
  throw InputError(std::move(errors));
}

}  // namespace dalembert
