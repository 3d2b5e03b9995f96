#include "diagnostics.hpp"

#include <fmt/format.h>

#include <utility>

namespace dalembert {

std::string to_string(const Diagnostic& d) {
  std::string text;
  if (!d.file.empty()) text += d.file + ": ";
  if (!d.element.empty()) text += d.element + ": ";
  text += fmt::format("{}: {}", d.severity == Severity::error ? "error" : "warning", d.message);
  if (!d.remedy.empty()) text += "; " + d.remedy;
  return text;
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
