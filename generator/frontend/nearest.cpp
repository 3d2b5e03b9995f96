#include "frontend/nearest.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <optional>
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

size_t edits_allowed(size_t length) { return std::max<size_t>(1, (length + 1) / 3); }

// "leftFoot-2" → left, foot, 2: in lower case, between separators, before capitals and around figures.
std::vector<std::string> parts_of(std::string_view name) {
  const auto is_digit = [](char c) { return '0' <= c && c <= '9'; };
  std::vector<std::string> parts(1);
  char last = 0;
  for (const char c : name) {
    const bool separates = c == '_' || c == '-' || c == ' ' || c == '.' || c == '/';
    const bool capital = 'A' <= c && c <= 'Z' && 'a' <= last && last <= 'z';
    if ((separates || capital || (last != 0 && is_digit(c) != is_digit(last))) && !parts.back().empty()) parts.emplace_back();
    if (!separates) parts.back() += lower(c);
    last = separates ? 0 : c;
  }
  if (parts.back().empty() && parts.size() > 1) parts.pop_back();
  return parts;
}

std::string joined(const std::vector<std::string>& parts) { return std::accumulate(parts.begin(), parts.end(), std::string()); }

// How a part of the name stands for one of the other's; smaller is nearer.
std::optional<double> cost_of_part(const std::string& part, const std::string& other) {
  if (part == other) return 0;
  if (other.starts_with(part) || (part.size() > 2 && part.starts_with(other) && other.size() > 2)) return 0.2;
  const size_t distance = edit_distance(part, other);
  if (part.size() > 2 && distance <= edits_allowed(part.size()) && distance < other.size())
    return 0.3 * static_cast<double>(distance);
  return std::nullopt;
}

// All of the name's parts among the other's, each once; what is over counts a little, and more where it stands in front.
std::optional<double> cost_of_parts(const std::vector<std::string>& parts, const std::vector<std::string>& others) {
  std::vector<bool> used(others.size(), false);
  double cost = 0;
  for (const std::string& part : parts) {
    std::optional<double> least;
    size_t at = 0;
    for (size_t i = 0; i < others.size(); ++i)
      if (const auto own = used[i] ? std::nullopt : cost_of_part(part, others[i]); own && (!least || *own < *least))
        least = own, at = i;
    if (!least) return std::nullopt;
    used[at] = true;
    cost += *least;
  }
  return cost + 0.25 * static_cast<double>(std::count(used.begin(), used.end(), false));
}

// How far the other name is by edits alone; nothing where it is too far.
std::optional<double> cost_of_edits(std::string_view name, std::string_view other) {
  const size_t allowed = edits_allowed(name.size()), longer = std::max(name.size(), other.size());
  if (longer - std::min(name.size(), other.size()) > allowed) return std::nullopt;
  const size_t distance = edit_distance(name, other);
  if (distance > allowed) return std::nullopt;
  return 1 + static_cast<double>(distance);
}

// … by whatever makes it a neighbour.
std::optional<double> cost(std::string_view name, std::string_view other) {
  const std::vector<std::string> parts = parts_of(name), others = parts_of(other);
  const std::string whole = joined(parts), its_whole = joined(others);
  // Closest of these is what an ending made distinct: 'a_b_' of 'a_b' (cpp_names.hpp).
  if (whole == its_whole) return other.starts_with(name) ? 0 : 0.001;
  std::vector<std::string> sorted = parts, its_sorted = others;
  std::sort(sorted.begin(), sorted.end());
  std::sort(its_sorted.begin(), its_sorted.end());
  if (sorted == its_sorted) return 0.5;
  std::optional<double> least;
  const auto may_be = [&](double value) { least = std::min(value, least.value_or(value)); };
  for (size_t i = 0; i + 1 < others.size() || i == 0; ++i) {  // one part as its first letter
    std::vector<std::string> abbreviated = others;
    abbreviated[i].resize(std::min<size_t>(1, abbreviated[i].size()));
    if (others.size() > 1 && joined(abbreviated) == whole) may_be(0.6);
  }
  if (const auto of_edits = cost_of_edits(name, other)) may_be(*of_edits);
  const double longer =
      0.01 * static_cast<double>(std::max(whole.size(), its_whole.size()) - std::min(whole.size(), its_whole.size()));
  if (whole.size() > 2 && (its_whole.starts_with(whole) || its_whole.ends_with(whole))) may_be(2.4 + longer);
  if (its_whole.size() > 2 && (whole.starts_with(its_whole) || whole.ends_with(its_whole))) may_be(2.5 + longer);
  if (parts.size() > 1 || whole.size() > 3)
    if (const auto of_parts = cost_of_parts(parts, others)) may_be(2.6 + *of_parts);
  return least;
}
}  // namespace

std::string suggestion(std::string_view name, const std::vector<std::string>& names, const std::vector<std::string>& also) {
  if (names.empty()) return "there is none to choose from";
  constexpr size_t many = 5000;  // of so many, edits alone are looked at
  std::vector<std::pair<double, const std::string*>> near;
  if (name.size() <= 200 && !name.empty())
    for (const auto* list : {&names, &also})
      for (const std::string& other : *list)
        if (!other.empty() && other.size() <= 200)
          if (const auto its_cost = names.size() + also.size() > many ? cost_of_edits(name, other) : cost(name, other))
            near.emplace_back(*its_cost, &other);
  if (!near.empty()) {
    std::stable_sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    const double least = near.front().first;
    std::vector<std::string> nearest;
    // Of those that hold the name nobody knows which was meant; of misspellings one is enough.
    for (const auto& [its_cost, other] : near)
      if (its_cost <= least + (least > 2.3 && least < 3 ? 0.051 : 0)) nearest.push_back(fmt::format("'{}'", *other));
    if (least < 2.3 || nearest.size() > 3) nearest.resize(1);
    return fmt::format("did you mean {}?", fmt::join(nearest, " or "));
  }
  constexpr size_t shown = 12;
  if (names.size() <= shown) return fmt::format("choose from {}", fmt::join(names, ", "));
  return fmt::format("choose from {} and {} more", fmt::join(names.begin(), names.begin() + shown, ", "), names.size() - shown);
}

}  // namespace dalembert::frontend
