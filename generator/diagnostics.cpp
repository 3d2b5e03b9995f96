#include "diagnostics.hpp"

#include <fmt/format.h>

#include <map>
#include <utility>

namespace dalembert {

std::string to_string(const Diagnostic& d) {
  std::string text;
  if (!d.file.empty()) text += d.file + ": ";
  if (!d.element.empty()) text += d.element + ": ";
  const char* names[] = {"notice", "warning", "error"};
  text += fmt::format("{}: {}", names[static_cast<int>(d.severity)], d.message);
  if (!d.remedy.empty()) text += "; " + d.remedy;
  return text;
}

std::vector<std::string> lines(const Diagnostics& diagnostics, bool verbose) {
  const auto kind = [](const Diagnostic& d) { return std::pair(d.file, d.kind.empty() ? d.message : d.kind); };
  std::map<std::pair<std::string, std::string>, int> count;
  for (const Diagnostic& d : diagnostics)
    if (d.severity == Severity::warning) ++count[kind(d)];
  std::vector<std::string> lines;
  for (const Diagnostic& d : diagnostics) {
    lines.push_back(to_string(d));
    if (verbose || d.severity != Severity::warning) continue;
    int& alike = count[kind(d)];
    if (alike == 0) lines.pop_back();  // told with the first
    if (alike > 1) lines.back() += fmt::format(" (the first of {} such warnings; --verbose shows all)", alike);
    alike = 0;
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
