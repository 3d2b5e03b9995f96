#include "backend/emit_driven.hpp"

#include <fmt/format.h>

#include <set>
#include <utility>
#include <vector>

#include "backend/emit_pairs.hpp"
#include "backend/kept.hpp"
#include "backend/literals.hpp"

namespace dalembert::backend {
namespace {

// Which elements of driven joints are added to which of the result, both as they stand in memory; `set` of them are the first
// to come where no other joints meet.
struct DrivenElements {
  std::vector<int> from, to;
  size_t set = 0;

  DrivenElements(const CodeInput& code, const ir::OutputArray& matrix) {
    const ir::KinematicTree& tree = code.tree;
    const int base = base_rows(code), rows = expanded_rows(code), nv = matrix.rows;
    const std::vector<int> coordinates = tree.coordinates();
    const auto row_of = [&](int i) { return matrix.row(i < base ? i : base + coordinates[static_cast<size_t>(i - base)]); };
    const auto asked = [&](int i) { return row_of(i) >= 0; };
    const auto driven = [&](int i) { return i >= base && tree.bodies[static_cast<size_t>(i - base)].driven(); };
    const auto meet = [&](int i, int k) {
      return i < base || k < base || tree.is_above(i - base, k - base) || tree.is_above(k - base, i - base);
    };
    std::set<int> written;
    for (int k = 0; k < rows; ++k)
      for (int i = 0; i < rows; ++i)
        if (!driven(i) && !driven(k) && asked(i) && asked(k) && meet(i, k)) written.insert(row_of(k) * nv + row_of(i));
    std::vector<std::pair<int, int>> first, more;  // from, to
    const auto add = [&](int at, int row, int column) {
      const int target = row_of(column) * nv + row_of(row);
      (written.insert(target).second ? first : more).emplace_back(at, target);
    };
    int number = 0;
    for (int d = base; d < rows; ++d) {
      if (!driven(d)) continue;
      for (int i = 0; i < rows; ++i) {
        if (!meet(i, d) || !asked(i) || !asked(d)) continue;
        add(number * rows + i, i, d);
        if (!driven(i)) add((driven_joints(code) + number) * rows + i, d, i);
      }
      ++number;
    }
    set = first.size();
    first.insert(first.end(), more.begin(), more.end());
    for (const auto& [a, b] : first) from.push_back(a), to.push_back(b);
  }
};

}  // namespace

std::string driven_tables(const CodeInput& code) {
  if (!has_driven(code)) return "";
  std::string text;
  for (const PairsOfRows& group : pairs_by_rows(code)) {
    std::vector<int> rows;
    const std::vector<int> coordinates = code.tree.coordinates();
    for (int j = 0; j < base_rows(code); ++j) rows.push_back(group.array->row(j));
    int driven = 0;
    for (int k = 0; k < code.tree.joints(); ++k)
      rows.push_back(code.tree.bodies[static_cast<size_t>(k)].driven()
                         ? -1 - driven++
                         : group.array->row(base_rows(code) + coordinates[static_cast<size_t>(k)]));
    const DrivenElements elements(code, *group.array);
    text +=
        "// Rows of the base and of every joint in the matrices; -1, -2, ... for mimic joints, which are added to those of "
        "the joints they follow.\n" +
        int_table("coordinate" + group.suffix, rows);
    if (!elements.to.empty())
      text += int_table("mimic_from" + group.suffix, elements.from) + int_table("mimic_to" + group.suffix, elements.to);
  }
  return text;
}

std::string driven_statements(const CodeInput& code) {
  if (!has_driven(code)) return "";
  std::string text;
  for (const PairsOfRows& group : pairs_by_rows(code)) {
    const DrivenElements elements(code, *group.array);
    for (const size_t p : group.pairs)
      if (!elements.to.empty())
        text +=
            fmt::format("  dalembert::add_mimic(scratch.mimic_{0}[0], mimic_from{3}, mimic_to{3}, {1}, {2}, workspace.{0});\n",
                        code.algorithm.arrays[static_cast<size_t>(code.algorithm.pairs[p].array)].name, elements.set,
                        elements.to.size(), group.suffix);
  }
  return (text.empty() ? "" : "  // Rows and columns of mimic joints are added to those of the joints they follow.\n") + text;
}

long driven_additions(const CodeInput& code) {
  if (!has_driven(code)) return 0;
  long additions = 0;
  for (const PairsOfRows& group : pairs_by_rows(code)) {
    const DrivenElements elements(code, *group.array);
    additions += static_cast<long>(group.pairs.size() * (elements.to.size() - elements.set));
  }
  return additions;
}

}  // namespace dalembert::backend
