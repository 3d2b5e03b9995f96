#include "backend/emit_pairs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "backend/graph_printer.hpp"
#include "backend/kept.hpp"
#include "backend/literals.hpp"
#include "dalembert/tile_shapes.hpp"

namespace dalembert::backend {
namespace {

// The limb that holds a body: its bodies, and the body it hangs on.
std::pair<std::vector<int>, int> limb_of(const CodeInput& code, int body) {
  for (const ir::Segment& s : code.plan.segments)
    for (size_t lane = 0; lane < s.bodies.size(); ++lane) {
      if (std::find(s.bodies[lane].begin(), s.bodies[lane].end(), body) == s.bodies[lane].end()) continue;
      std::vector<int> limb = s.bodies[lane];
      std::erase(limb, -1);
      return {limb, s.parents[lane]};
    }
  return {{}, -1};
}

// The limbs above a limb that hangs on `parent`, as bodies, the one nearest the base first.
std::vector<std::vector<int>> limbs_above(const CodeInput& code, int parent) {
  std::vector<std::vector<int>> above;
  while (parent >= 0) {
    auto [limb, next] = limb_of(code, parent);
    above.insert(above.begin(), std::move(limb));
    parent = next;
  }
  return above;
}

// The limbs at one level above a segment, lane by lane; empty where a lane has none there. Levels count from the base: that
// is where most lanes have the same limb above them.
struct Above {
  std::vector<std::vector<int>> limbs;
  size_t steps = 0;

  // The one limb that is above all lanes that have a limb above them; empty where there are several.
  std::vector<int> shared() const {
    std::vector<int> one;
    for (const auto& limb : limbs) {
      if (!one.empty() && !limb.empty() && limb != one) return {};
      if (!limb.empty()) one = limb;
    }
    return one;
  }
};

// Where limbs above stand side by side in one segment, from its start on: which of its lanes is above each lane.
struct SideBySide {
  const ir::Segment* segment = nullptr;  // nullptr: they do not
  std::vector<int> lanes;
};
SideBySide side_by_side(const CodeInput& code, const Above& above) {
  SideBySide found;
  for (const std::vector<int>& limb : above.limbs) {
    found.lanes.push_back(0);
    if (limb.empty()) continue;
    const ir::Segment& s = code.plan.segments[static_cast<size_t>(code.plan.segment_of(limb.front()))];
    if (s.width == 1 || (found.segment && found.segment != &s)) return {};
    found.segment = &s;
    for (size_t lane = 0; lane < s.bodies.size(); ++lane)
      if (s.bodies[lane].front() == limb.front()) found.lanes.back() = static_cast<int>(lane);
  }
  return found;
}

std::vector<Above> all_above(const CodeInput& code, const ir::Segment& segment) {
  std::vector<Above> levels;
  for (size_t lane = 0; lane < segment.parents.size(); ++lane) {
    auto limbs = limbs_above(code, segment.parents[lane]);
    if (limbs.size() > levels.size()) levels.resize(limbs.size(), {std::vector<std::vector<int>>(segment.parents.size()), 0});
    for (size_t level = 0; level < limbs.size(); ++level) {
      levels[level].steps = std::max(levels[level].steps, limbs[level].size());
      levels[level].limbs[lane] = std::move(limbs[level]);
    }
  }
  return levels;
}

// First row and length of each lane's limb.
void rows_of(const CodeInput& code, const std::vector<std::vector<int>>& limbs, std::vector<int>& first,
             std::vector<int>& length) {
  for (const auto& limb : limbs) {
    const int real = static_cast<int>(std::count_if(limb.begin(), limb.end(), [](int b) { return b >= 0; }));
    first.push_back(real > 0 ? base_rows(code) + limb.front() : 0);
    length.push_back(real);
  }
}

// Three components of a role, as a factor of elements.
using Factor = std::pair<int, int>;  // role, first component

int number_of(std::vector<Factor>& factors, const Factor& factor) {
  const auto at = std::find(factors.begin(), factors.end(), factor);
  if (at != factors.end()) return static_cast<int>(at - factors.begin());
  factors.push_back(factor);
  return static_cast<int>(factors.size()) - 1;
}

// The factors of all matrices, each once, and the type that says how elements are made of them.
struct Products {
  std::vector<Factor> lower, upper;
  std::string type;

  explicit Products(const CodeInput& code) {
    std::vector<std::string> kinds;
    for (const ir::Pairs& p : code.algorithm.pairs)
      kinds.push_back(p.symmetric ? fmt::format("dalembert::Symmetric<{}>", sum(p.above))
                                  : fmt::format("dalembert::Square<{}, {}>", sum(p.above), sum(p.below)));
    type = fmt::format("dalembert::Matrices<{}>", fmt::join(kinds, ",\n                                   "));
  }
  std::string sum(const std::vector<ir::PairTerm>& terms) {
    std::vector<std::string> texts;
    for (const ir::PairTerm& t : terms)
      texts.push_back(fmt::format("dalembert::Term<{}, {}>", number_of(lower, {t.lower, t.lower_from}),
                                  number_of(upper, {t.upper, t.upper_from})));
    return fmt::format("dalembert::Sum<{}>", fmt::join(texts, ", "));
  }
};

std::string factors_text(const CodeInput& code, const std::string& name, const std::vector<Factor>& factors) {
  std::vector<std::string> texts;
  for (const auto& [role, component] : factors) texts.push_back(kept(code, role, component));
  return fmt::format("  const dalembert::Factors<Scalar, {}> {}{{{{{}}}, {}}};\n", factors.size(), name, fmt::join(texts, ", "),
                     stride(code));
}

// Where the elements of a matrix go: to the result, and beside it what is driven joints'.
std::string matrix_of(const CodeInput& code, const ir::Pairs& p) {
  const std::string& name = code.algorithm.arrays[static_cast<size_t>(p.array)].name;
  return has_driven(code) ? fmt::format("{{workspace.{0}, scratch.mimic_{0}[0], coordinate, {1}, {2}}}", name,
                                        expanded_rows(code), driven_joints(code))
                          : "workspace." + name;
}

// The function of blocks.hpp for the blocks between a segment and the limbs at one level above it, and how it is told where
// these stand.
struct Crossing {
  std::string function, type, slots;
};
Crossing crossing_of(const CodeInput& code, const ir::Segment& segment, size_t level, const Above& above) {
  if (const std::vector<int> one = above.shared(); !one.empty()) {
    const int first = slot_of(code, one.front());
    return {"shared_cross_blocks", "", fmt::format("{}, {}", first, one.size() == 1 ? 0 : slot_of(code, one[1]) - first)};
  }
  if (const SideBySide found = side_by_side(code, above); found.segment)
    return {"lane_cross_blocks",
            fmt::format(", dalembert::LanesAbove<{}, {}>", found.segment->width, fmt::join(found.lanes, ", ")),
            std::to_string(found.segment->first_slot)};
  return {"cross_blocks", "", fmt::format("{}_above_{}_slot", segment.name, level + 1)};
}

}  // namespace

bool elements_split(const ir::Segment& segment) { return segment.steps > 8; }

std::string pairs_types(const CodeInput& code) {
  if (code.algorithm.pairs.empty()) return "";
  std::string text;
  for (const ir::Pairs& p : code.algorithm.pairs)
    text += fmt::format("// {}: {}\n", code.algorithm.arrays[static_cast<size_t>(p.array)].name, p.equation);
  return "\n" + text + fmt::format("using Elements = {};\n", Products(code).type);
}

std::string limb_tables(const CodeInput& code, size_t segment) {
  if (code.algorithm.pairs.empty()) return "";
  const ir::Segment& s = code.plan.segments[segment];
  std::string text;
  std::vector<int> first, length;
  rows_of(code, s.bodies, first, length);
  if (s.width > 1) text += int_table(s.name + "_row", first) + int_table(s.name + "_length", length);
  const std::vector<Above> levels = all_above(code, s);
  for (size_t level = 0; level < levels.size(); ++level) {
    const Above& a = levels[level];
    std::vector<int> above_first, above_length, slots;
    rows_of(code, a.limbs, above_first, above_length);
    for (size_t step = 0; step < a.steps; ++step)
      for (const auto& limb : a.limbs) slots.push_back(step < limb.size() ? slot_of(code, limb[step]) : slot_of(code, -1));
    const std::string prefix = fmt::format("{}_above_{}", s.name, level + 1);
    if (s.width == 1 || (a.shared().empty() && !side_by_side(code, a).segment)) text += int_table(prefix + "_slot", slots);
    if (s.width > 1) text += int_table(prefix + "_row", above_first) + int_table(prefix + "_length", above_length);
  }
  return text;
}

std::string elements_stage(const CodeInput& code, size_t segment) {
  const ir::Segment& s = code.plan.segments[segment];
  const Products products(code);
  std::vector<std::string> matrices, equations;
  for (const ir::Pairs& p : code.algorithm.pairs) {
    matrices.push_back(matrix_of(code, p));
    equations.push_back(p.equation);
  }
  std::string text = fmt::format("  // {}\n", fmt::join(equations, ". "));
  text += factors_text(code, "lower", products.lower) + factors_text(code, "upper", products.upper);
  text += fmt::format("  {} matrices[] = {{{}}};\n", has_driven(code) ? "const dalembert::Reduced<Scalar>" : "Scalar* const",
                      fmt::join(matrices, ", "));
  const std::vector<Above> levels = all_above(code, s);
  const std::string end = elements_split(s) ? "nv, begin, end" : fmt::format("nv, 0, {}", s.steps);
  const int row = s.width > 1 ? 0 : base_rows(code) + s.bodies[0].front();
  if (s.width > 1) {
    text += fmt::format("  constexpr dalembert::BranchTable branches{{{0}_row, {0}_length, {1}}};\n", s.name, s.first_slot);
    text += fmt::format("  dalembert::branch_blocks<Elements, {}, {}, Scalar>(lower, upper, branches, matrices, {});\n",
                        s.limbs(), s.steps, end);
    for (size_t level = 0; level < levels.size(); ++level) {
      const Crossing crossing = crossing_of(code, s, level, levels[level]);
      text += fmt::format(
          "  constexpr dalembert::BranchTable above_{1}{{{0}_above_{1}_row, {0}_above_{1}_length, 0}};\n"
          "  dalembert::{2}<Elements, {3}, {4}, {5}, Scalar{6}>(lower, upper, branches, {7}, above_{1}, matrices, {8});\n",
          s.name, level + 1, crossing.function, s.limbs(), s.steps, levels[level].steps, crossing.type, crossing.slots, end);
    }
  } else {
    text += fmt::format("  dalembert::run_block<Elements, Scalar>(lower, upper, {}, {}, {}, matrices, {});\n", s.first_slot,
                        row, s.steps, end);
    for (size_t level = 0; level < levels.size(); ++level)
      text += fmt::format(
          "  dalembert::run_cross_block<Elements, {}, Scalar>(lower, upper, {}, {}, {}_above_{}_slot, {}, matrices, {});\n",
          levels[level].steps, s.first_slot, row, s.name, level + 1, base_rows(code) + levels[level].limbs[0].front(), end);
  }
  if (!code.tree.floating_base) return text;
  const auto base = [&](const char* what, int role, const std::string& matrix) {
    return s.width > 1 ? fmt::format("  dalembert::base_{}<{}, {}, Scalar>({}, {}, branches, {}, nv);\n", what, s.limbs(),
                                     s.steps, kept(code, role, 0), stride(code), matrix)
                       : fmt::format("  dalembert::run_base_{}<Scalar>({}, {}, {}, {}, {}, {}, nv);\n", what,
                                     kept(code, role, 0), stride(code), s.first_slot, row, s.steps, matrix);
  };
  text += "  // The base's rows and columns.\n";
  if (elements_split(s)) text += "  if (begin > 0) return;\n";
  for (size_t p = 0; p < matrices.size(); ++p) {
    const std::string matrix = has_driven(code) ? fmt::format("matrices[{}]", p) : matrices[p];
    text += base("columns", code.rolled.pairs[p].columns, matrix);
    if (code.rolled.pairs[p].rows >= 0) text += base("rows", code.rolled.pairs[p].rows, matrix);
  }
  return text;
}

namespace {

// Tiles of four steps by four, as blocks.hpp goes through them; both triangles of a symmetric matrix are one.
void tile_counts(const ir::Segment& s, const std::vector<Above>& levels, int factors, bool symmetric, int lanes,
                 ElementCounts& counts) {
  const int limbs = s.computed_of_tiles(lanes);
  const auto tile = [&](bool written_out, int rows, int columns, bool diagonal) {
    const long above = limbs * (diagonal ? rows * (rows + 1) / 2 : rows * columns);
    const long below = symmetric ? 0 : limbs * (diagonal ? rows * (rows - 1) / 2 : rows * columns);
    counts.above += above, counts.below += below;
    if (products_loop(written_out, rows, columns, diagonal)) counts.added_to_zero += above + below;
  };
  for (int c = 0; c < s.steps; c += 4) {
    const int columns = std::min(4, s.steps - c);
    for (int r = 0; r < c; r += 4) tile(block_written_out(s.steps), 4, columns, false);
    tile(block_written_out(s.steps), columns, columns, true);
    for (const Above& a : levels) {
      const int above = static_cast<int>(a.steps);
      for (int r = 0; r < above; r += 4)
        tile(block_written_out(s.steps, above, factors), std::min(4, above - r), columns, false);
    }
  }
}

}  // namespace

ElementCounts element_counts(const CodeInput& code, size_t segment, const ir::Pairs& pairs, int lanes) {
  const ir::Segment& s = code.plan.segments[segment];
  const std::vector<Above> levels = all_above(code, s);
  ElementCounts counts;
  if (s.width > 1) {
    tile_counts(s, levels, static_cast<int>(Products(code).lower.size()), pairs.symmetric, lanes, counts);
    return counts;
  }
  const auto driven = [&](int body) { return code.tree.bodies[static_cast<size_t>(body)].driven(); };
  // Some rows of a joint's column, run by run between driven joints.
  const auto rows = [&](int column, const int* first, const int* last) {
    long total = 0, run = 0;
    const auto end_run = [&] { total += (run + lanes - 1) / lanes * lanes, run = 0; };
    for (; first != last; ++first) {
      ++run;
      if (!driven(*first) || driven(column)) continue;
      --run;
      end_run();
      total += lanes;
    }
    end_run();
    return total;
  };
  const std::vector<int>& limb = s.bodies[0];
  const int *begin = limb.data(), *end = begin + limb.size();
  for (const int* k = begin; k != end; ++k) {
    counts.above += rows(*k, begin, k + 1);
    counts.below += rows(*k, k + 1, end);
  }
  for (const Above& a : levels) {
    const std::vector<int>& above = a.limbs[0];
    for (const int k : limb) counts.above += rows(k, above.data(), above.data() + above.size());
    for (const int i : above) counts.below += rows(i, begin, end);
  }
  return counts;
}

}  // namespace dalembert::backend
