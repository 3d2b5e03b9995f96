#include "backend/emit_driven.hpp"

#include <fmt/format.h>

#include <set>
#include <utility>
#include <vector>

#include "backend/kept.hpp"
#include "backend/literals.hpp"

namespace dalembert::backend {
namespace {

// Which elements of driven joints are added to which of the result, both as they stand in memory; `set` of them are the first
// to come where no other joints meet.
struct DrivenElements {
  std::vector<int> from, to;
  size_t set = 0;

  explicit DrivenElements(const CodeInput& code) {
    const ir::KinematicTree& tree = code.tree;
    const int base = base_rows(code), rows = expanded_rows(code), nv = tree.nv();
    const std::vector<int> coordinates = tree.coordinates();
    const auto row_of = [&](int i) { return i < base ? i : base + coordinates[static_cast<size_t>(i - base)]; };
    const auto driven = [&](int i) { return i >= base && tree.bodies[static_cast<size_t>(i - base)].driven(); };
    const auto meet = [&](int i, int k) {
      return i < base || k < base || tree.is_above(i - base, k - base) || tree.is_above(k - base, i - base);
    };
    std::set<int> written;
    for (int k = 0; k < rows; ++k)
      for (int i = 0; i < rows; ++i)
        if (!driven(i) && !driven(k) && meet(i, k)) written.insert(row_of(k) * nv + row_of(i));
    std::vector<std::pair<int, int>> first, more;  // from, to
    const auto add = [&](int at, int row, int column) {
      const int target = row_of(column) * nv + row_of(row);
      (written.insert(target).second ? first : more).emplace_back(at, target);
    };
    int number = 0;
    for (int d = base; d < rows; ++d) {
      if (!driven(d)) continue;
      for (int i = 0; i < rows; ++i) {
        if (!meet(i, d)) continue;
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
  if (!has_driven(code) || code.algorithm.pairs.empty()) return "";
  std::vector<int> rows;
  const std::vector<int> coordinates = code.tree.coordinates();
  for (int j = 0; j < base_rows(code); ++j) rows.push_back(j);
  int driven = 0;
  for (int k = 0; k < code.tree.joints(); ++k)
    rows.push_back(code.tree.bodies[static_cast<size_t>(k)].driven() ? -1 - driven++
                                                                     : base_rows(code) + coordinates[static_cast<size_t>(k)]);
  const DrivenElements elements(code);
  return "// Rows of the base and of every joint in the matrices; -1, -2, ... for mimic joints, which are added to those of "
         "the joints they follow.\n" +
         int_table("coordinate", rows) + int_table("mimic_from", elements.from) + int_table("mimic_to", elements.to);
}

std::string driven_statements(const CodeInput& code) {
  if (!has_driven(code) || code.algorithm.pairs.empty()) return "";
  const DrivenElements elements(code);
  std::string text = "  // Rows and columns of mimic joints are added to those of the joints they follow.\n";
  for (const ir::Pairs& p : code.algorithm.pairs)
    text += fmt::format("  dalembert::add_mimic(scratch.mimic_{0}[0], mimic_from, mimic_to, {1}, {2}, workspace.{0});\n",
                        code.algorithm.arrays[static_cast<size_t>(p.array)].name, elements.set, elements.to.size());
  return text;
}

long driven_additions(const CodeInput& code) {
  if (!has_driven(code) || code.algorithm.pairs.empty()) return 0;
  const DrivenElements elements(code);
  return static_cast<long>(code.algorithm.pairs.size() * (elements.to.size() - elements.set));
}

}  // namespace dalembert::backend
