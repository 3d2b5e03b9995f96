#include "frontend/nearest.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace dalembert::frontend {

namespace {
char lower(char c) { return 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

// Levenshtein's distance, upper and lower case being equal; two neighbours that changed places are one edit, not two.
size_t edit_distance(std::string_view a, std::string_view b) {
  const auto same = [&](size_t i, size_t j) { return lower(a[i]) == lower(b[j]); };
  std::vector<size_t> before(b.size() + 1), row(b.size() + 1), next(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 0; i < a.size(); ++i) {
    next[0] = i + 1;
    for (size_t j = 0; j < b.size(); ++j) {
      next[j + 1] = std::min({row[j] + (same(i, j) ? 0 : 1), next[j] + 1, row[j + 1] + 1});
      if (i > 0 && j > 0 && same(i, j - 1) && same(i - 1, j)) next[j + 1] = std::min(next[j + 1], before[j - 1] + 1);
    }
    std::swap(before, row);
    std::swap(row, next);
  }
  return row.back();
}
}  // namespace

std::string suggestion(std::string_view name, const std::vector<std::string>& names) {
  if (names.empty()) return "there is none to choose from";
  // Names that are long, or far longer or shorter than this one, need not be compared.
  size_t least = std::max<size_t>(1, (name.size() + 1) / 3) + 1;
  const std::string* nearest = nullptr;
  for (const std::string& other : names) {
    const size_t longer = std::max(name.size(), other.size());
    if (longer > 200 || longer - std::min(name.size(), other.size()) >= least) continue;
    const size_t distance = edit_distance(name, other);
    if (distance >= least) continue;
    least = distance;
    nearest = &other;
  }
  if (nearest) return fmt::format("did you mean '{}'?", *nearest);
  constexpr size_t shown = 12;
  if (names.size() <= shown) return fmt::format("choose from {}", fmt::join(names, ", "));
  return fmt::format("choose from {} and {} more", fmt::join(names.begin(), names.begin() + shown, ", "), names.size() - shown);
}

}  // namespace dalembert::frontend
