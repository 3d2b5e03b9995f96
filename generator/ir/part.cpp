#include "ir/part.hpp"

#include <algorithm>

#include "ir/kinematic_tree.hpp"
#include "ir/moved_links.hpp"

namespace dalembert::ir {

namespace {

bool of_bodies(Extent extent) { return extent == Extent::six_per_body || extent == Extent::ten_per_body; }

}  // namespace

bool is_pattern(std::string_view text) { return text.find_first_of("*?") != text.npos; }

bool matches(std::string_view pattern, std::string_view name) {
  std::size_t p = 0, n = 0, star = pattern.npos, from = 0;
  while (n < name.size()) {
    if (p < pattern.size() && (pattern[p] == '?' || (pattern[p] != '*' && pattern[p] == name[n]))) {
      ++p, ++n;
    } else if (p < pattern.size() && pattern[p] == '*') {
      star = p++, from = n;
    } else if (star != pattern.npos) {
      p = star + 1, n = ++from;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

Parts parts_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::mass_matrix:
    case Quantity::coriolis_matrix:
    case Quantity::gravity:
    case Quantity::bias:
    case Quantity::inverse_dynamics:
    case Quantity::center_of_mass_jacobian:
    case Quantity::momentum_matrix: return {true, false};
    case Quantity::wrench_influence:
    case Quantity::regressor: return {true, true};
    default: return {false, false};
  }
}

bool has_parts(Extent rows, Extent columns) { return rows == Extent::nv || columns == Extent::nv; }

std::optional<std::vector<int>> chosen(const Part* part, Extent extent) {
  if (part && extent == Extent::nv && part->some_coordinates) return part->coordinates;
  if (!part || !of_bodies(extent) || !part->some_links) return {};
  const int each = extent == Extent::six_per_body ? 6 : 10;
  std::vector<int> columns;
  for (const int body : part->bodies)
    for (int i = 0; i < each; ++i) columns.push_back(each * body + i);
  return columns;
}

Eigen::MatrixXd Selection::of(const Eigen::MatrixXd& result) const {
  if (whole()) return result;
  const auto all = [](Eigen::Index count) {
    std::vector<int> numbers;
    for (int i = 0; i < count; ++i) numbers.push_back(i);
    return numbers;
  };
  return result(rows ? *rows : all(result.rows()), columns ? *columns : all(result.cols()));
}

Selection selection(const Part* part, Extent rows, Extent columns) { return {chosen(part, rows), chosen(part, columns)}; }

int extent(Extent extent, const KinematicTree& tree, const Part* part) {
  if (const auto some = chosen(part, extent)) return static_cast<int>(some->size());
  return ir::extent(extent, tree);
}

std::vector<int> map_of(const Part* part, Extent extent, const KinematicTree& tree) {
  const auto some = chosen(part, extent);
  if (!some) return {};
  std::vector<int> map(static_cast<std::size_t>(ir::extent(extent, tree)), -1);
  for (std::size_t i = 0; i < some->size(); ++i) map[static_cast<std::size_t>((*some)[i])] = static_cast<int>(i);
  return map;
}

std::string in_words(const Part& part, Extent rows, Extent columns, const KinematicTree& tree) {
  std::string text;
  const auto add = [&](const char* what, const std::string& of) {
    text += (text.empty() ? "" : "; ") + std::string(what) + ": " + of;
  };
  if (part.some_coordinates && has_parts(rows, columns)) {
    std::vector<std::string> names;
    for (const Body& body : tree.bodies)
      if (!body.driven()) names.push_back(body.joint);
    const int base = tree.base_coordinates();
    std::string of;
    for (std::size_t i = 0; i < part.coordinates.size();) {
      const int k = part.coordinates[i] - base;
      if (k < 0) {
        of = "the base's six";
        i += 6;
        continue;
      }
      std::size_t end = i + 1;
      while (end < part.coordinates.size() && part.coordinates[end] == part.coordinates[end - 1] + 1) ++end;
      const auto name = [&](std::size_t at) { return names[static_cast<std::size_t>(part.coordinates[at] - base)]; };
      const std::string run = end - i > 2    ? name(i) + " to " + name(end - 1)
                              : end - i == 2 ? name(i) + ", " + name(i + 1)
                                             : name(i);
      of += (of.empty() ? "" : ", ") + run;
      i = end;
    }
    add(rows == Extent::nv && columns == Extent::nv ? "rows and columns" : rows == Extent::nv ? "rows" : "columns", of);
  }
  if (part.some_links && of_bodies(columns)) {
    const std::vector<int> numbers = numbers_of_links(tree);
    std::string of;
    for (const int number : part.bodies) {
      std::string name = tree.base_link;
      for (std::size_t k = 0; k < numbers.size(); ++k)
        if (numbers[k] == number) name = tree.bodies[k].name;
      of += (of.empty() ? "" : ", ") + name;
    }
    add("columns", of);
  }
  return text;
}

}  // namespace dalembert::ir
