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

// Whether the matrices have rows of the limb's joints: then of all of them.
bool asked(const PairsOfRows& group, const std::vector<int>& limb) {
  return !limb.empty() && limb.front() >= 0 && group.rows[static_cast<size_t>(limb.front())] >= 0;
}

// The segment's limbs, those without rows being empty.
std::vector<std::vector<int>> limbs_asked(const PairsOfRows& group, const ir::Segment& segment) {
  std::vector<std::vector<int>> limbs = segment.bodies;
  for (auto& limb : limbs)
    if (!asked(group, limb)) limb.clear();
  return limbs;
}

bool any_asked(const PairsOfRows& group, const ir::Segment& segment) {
  return std::any_of(segment.bodies.begin(), segment.bodies.end(), [&](const auto& limb) { return asked(group, limb); });
}

std::vector<Above> all_above(const CodeInput& code, const PairsOfRows& group, const ir::Segment& segment) {
  std::vector<Above> levels;
  for (size_t lane = 0; lane < segment.parents.size(); ++lane) {
    auto limbs = limbs_above(code, segment.parents[lane]);
    for (auto& limb : limbs)
      if (!asked(group, limb) || !asked(group, segment.bodies[lane])) limb.clear();
    if (limbs.size() > levels.size()) levels.resize(limbs.size(), {std::vector<std::vector<int>>(segment.parents.size()), 0});
    for (size_t level = 0; level < limbs.size(); ++level) {
      levels[level].steps = std::max(levels[level].steps, limbs[level].size());
      levels[level].limbs[lane] = std::move(limbs[level]);
    }
  }
  return levels;
}

// The first row of a limb. Where joints are driven rows are those that all joints would have (emit_driven.hpp).
int first_row(const CodeInput& code, const PairsOfRows& group, const std::vector<int>& limb) {
  if (has_driven(code)) return base_rows(code) + limb.front();
  return group.rows[static_cast<size_t>(limb.front())];
}

// First row and length of each lane's limb.
void rows_of(const CodeInput& code, const PairsOfRows& group, const std::vector<std::vector<int>>& limbs,
             std::vector<int>& first, std::vector<int>& length) {
  for (const auto& limb : limbs) {
    const int real = static_cast<int>(std::count_if(limb.begin(), limb.end(), [](int b) { return b >= 0; }));
    first.push_back(real > 0 ? first_row(code, group, limb) : 0);
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

  Products(const CodeInput& code, const PairsOfRows& group) {
    std::vector<std::string> kinds;
    for (const size_t number : group.pairs) {
      const ir::Pairs& p = code.algorithm.pairs[number];
      kinds.push_back(p.symmetric ? fmt::format("dalembert::Symmetric<{}>", sum(p.above))
                                  : fmt::format("dalembert::Square<{}, {}>", sum(p.above), sum(p.below)));
    }
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
std::string matrix_of(const CodeInput& code, const PairsOfRows& group, const ir::Pairs& p) {
  const std::string& name = code.algorithm.arrays[static_cast<size_t>(p.array)].name;
  return has_driven(code) ? fmt::format("{{workspace.{0}, scratch.mimic_{0}[0], coordinate{3}, {1}, {2}}}", name,
                                        expanded_rows(code), driven_joints(code), group.suffix)
                          : "workspace." + name;
}

// Limbs as the runtime takes long ones: where their slots are, and their rows.
std::string long_limb_table(const CodeInput& code, const PairsOfRows& group, const std::string& name,
                            const std::vector<std::vector<int>>& limbs) {
  std::vector<int> first, length;
  rows_of(code, group, limbs, first, length);
  std::vector<std::string> texts;
  for (size_t lane = 0; lane < limbs.size(); ++lane) {
    const std::vector<int>& limb = limbs[lane];
    const int slot = length[lane] > 0 ? slot_of(code, limb[0]) : 0;
    const int step = length[lane] > 1 ? slot_of(code, limb[1]) - slot : 1;
    texts.push_back(fmt::format("{{{}, {}, {}, {}}}", slot, step, first[lane], length[lane]));
  }
  return fmt::format("constexpr dalembert::LongLimb {}[] = {{{}}};\n", name, fmt::join(texts, ", "));
}

// The function of blocks.hpp for the blocks between a segment and the limbs at one level above it, and how it is told where
// these stand.
struct Crossing {
  std::string function, type, slots;
};
Crossing crossing_of(const CodeInput& code, const PairsOfRows& group, const ir::Segment& segment, size_t level,
                     const Above& above) {
  if (const std::vector<int> one = above.shared(); !one.empty()) {
    const int first = slot_of(code, one.front());
    return {"shared_cross_blocks", "", fmt::format("{}, {}", first, one.size() == 1 ? 0 : slot_of(code, one[1]) - first)};
  }
  if (const SideBySide found = side_by_side(code, above); found.segment)
    return {"lane_cross_blocks",
            fmt::format(", dalembert::LanesAbove<{}, {}>", found.segment->width, fmt::join(found.lanes, ", ")),
            std::to_string(found.segment->first_slot)};
  return {"cross_blocks", "", fmt::format("{}_above_{}_slot{}", segment.name, level + 1, group.suffix)};
}

}  // namespace

bool limb_after_limb(const CodeInput& code, const ir::Segment& segment) {
  return !has_driven(code) && segment.steps >= (segment.width > 1 ? long_limb_beside_others : long_limb);
}

bool elements_split(const CodeInput& code, const ir::Segment& segment) {
  return segment.steps > 8 || limb_after_limb(code, segment);
}

int split_columns(const CodeInput& code, const ir::Segment& segment) {
  if (!limb_after_limb(code, segment)) return segment.steps;
  int columns = 0;
  for (const auto& limb : segment.bodies)
    columns += static_cast<int>(std::count_if(limb.begin(), limb.end(), [](int b) { return b >= 0; }));
  return columns;
}

std::vector<PairsOfRows> pairs_by_rows(const CodeInput& code) {
  std::vector<PairsOfRows> groups;
  const std::vector<int> coordinates = code.tree.coordinates();
  for (size_t p = 0; p < code.algorithm.pairs.size(); ++p) {
    const ir::OutputArray& array = code.algorithm.arrays[static_cast<size_t>(code.algorithm.pairs[p].array)];
    const auto same = std::find_if(groups.begin(), groups.end(),
                                   [&](const PairsOfRows& group) { return group.array->row_map == array.row_map; });
    if (same != groups.end()) {
      same->pairs.push_back(p);
      continue;
    }
    groups.push_back({{p}, &array, {}, groups.empty() ? "" : fmt::format("_{}", groups.size() + 1)});
    for (const int coordinate : coordinates) groups.back().rows.push_back(array.row(base_rows(code) + coordinate));
  }
  return groups;
}

std::string pairs_types(const CodeInput& code) {
  std::string text;
  for (const PairsOfRows& group : pairs_by_rows(code)) {
    text += "\n";
    for (const size_t number : group.pairs) {
      const ir::Pairs& p = code.algorithm.pairs[number];
      text += fmt::format("// {}: {}\n", code.algorithm.arrays[static_cast<size_t>(p.array)].name, p.equation);
    }
    text += fmt::format("using Elements{} = {};\n", group.suffix, Products(code, group).type);
  }
  return text;
}

std::string limb_tables(const CodeInput& code, size_t segment) {
  std::string text;
  for (const PairsOfRows& group : pairs_by_rows(code)) {
    const ir::Segment& s = code.plan.segments[segment];
    if (!any_asked(group, s)) continue;
    const bool one_by_one = limb_after_limb(code, s), with_base = code.rolled.pairs[group.pairs.front()].columns >= 0;
    const std::vector<Above> levels = all_above(code, group, s);
    if (one_by_one) {
      text += long_limb_table(code, group, s.name + "_branches" + group.suffix, limbs_asked(group, s));
      for (size_t level = 0; level < levels.size(); ++level)
        if (levels[level].steps > 0)
          text +=
              long_limb_table(code, group, fmt::format("{}_above_{}{}", s.name, level + 1, group.suffix), levels[level].limbs);
    }
    if (s.width > 1 && (with_base || !one_by_one)) {
      std::vector<int> first, length;
      rows_of(code, group, limbs_asked(group, s), first, length);
      text += int_table(s.name + "_row" + group.suffix, first) + int_table(s.name + "_length" + group.suffix, length);
    }
    if (one_by_one) continue;
    for (size_t level = 0; level < levels.size(); ++level) {
      const Above& a = levels[level];
      if (a.steps == 0) continue;
      std::vector<int> above_first, above_length, slots;
      rows_of(code, group, a.limbs, above_first, above_length);
      for (size_t step = 0; step < a.steps; ++step)
        for (const auto& limb : a.limbs) slots.push_back(step < limb.size() ? slot_of(code, limb[step]) : slot_of(code, -1));
      const std::string prefix = fmt::format("{}_above_{}", s.name, level + 1);
      if (s.width == 1 || (a.shared().empty() && !side_by_side(code, a).segment))
        text += int_table(prefix + "_slot" + group.suffix, slots);
      if (s.width > 1)
        text +=
            int_table(prefix + "_row" + group.suffix, above_first) + int_table(prefix + "_length" + group.suffix, above_length);
    }
  }
  return text;
}

namespace {

// Of one group; `alone`: there is no other.
std::string elements_of_group(const CodeInput& code, const PairsOfRows& group, const ir::Segment& s, bool alone) {
  const Products products(code, group);
  std::vector<std::string> matrices, equations;
  for (const size_t number : group.pairs) {
    matrices.push_back(matrix_of(code, group, code.algorithm.pairs[number]));
    equations.push_back(code.algorithm.pairs[number].equation);
  }
  std::string text = fmt::format("  // {}\n", fmt::join(equations, ". "));
  text += factors_text(code, "lower", products.lower) + factors_text(code, "upper", products.upper);
  text += fmt::format("  {} matrices[] = {{{}}};\n", has_driven(code) ? "const dalembert::Reduced<Scalar>" : "Scalar* const",
                      fmt::join(matrices, ", "));
  const std::vector<Above> levels = all_above(code, group, s);
  const std::string leading = group.array->is_part() ? std::to_string(group.array->rows) : "nv";
  const bool split = elements_split(code, s);
  const std::string end = leading + (split ? ", begin, end" : fmt::format(", 0, {}", s.steps));
  const int row = s.width > 1 ? 0 : first_row(code, group, s.bodies[0]);
  const std::string elements = "Elements" + group.suffix;
  const bool with_base = code.rolled.pairs[group.pairs.front()].columns >= 0;
  if (s.width > 1 && (with_base || !limb_after_limb(code, s)))
    text += fmt::format("  constexpr dalembert::BranchTable branches{{{0}_row{2}, {0}_length{2}, {1}}};\n", s.name,
                        s.first_slot, group.suffix);
  if (limb_after_limb(code, s)) {
    const std::string limbs = s.name + "_branches" + group.suffix;
    text += fmt::format("  dalembert::long_limb_blocks<{}, Scalar>(lower, upper, {}, {}, matrices, {});\n", elements, limbs,
                        s.bodies.size(), end);
    for (size_t level = 0; level < levels.size(); ++level)
      if (levels[level].steps > 0)
        text +=
            fmt::format("  dalembert::long_limb_cross_blocks<{}, Scalar>(lower, upper, {}, {}_above_{}{}, {}, matrices, {});\n",
                        elements, limbs, s.name, level + 1, group.suffix, s.bodies.size(), end);
  } else if (s.width > 1) {
    text += fmt::format("  dalembert::branch_blocks<{}, {}, {}, Scalar>(lower, upper, branches, matrices, {});\n", elements,
                        s.limbs(), s.steps, end);
    for (size_t level = 0; level < levels.size(); ++level) {
      if (levels[level].steps == 0) continue;
      const Crossing crossing = crossing_of(code, group, s, level, levels[level]);
      text += fmt::format(
          "  constexpr dalembert::BranchTable above_{1}{{{0}_above_{1}_row{9}, {0}_above_{1}_length{9}, 0}};\n"
          "  dalembert::{2}<{10}, {3}, {4}, {5}, Scalar{6}>(lower, upper, branches, {7}, above_{1}, matrices, {8});\n",
          s.name, level + 1, crossing.function, s.limbs(), s.steps, levels[level].steps, crossing.type, crossing.slots, end,
          group.suffix, elements);
    }
  } else {
    text += fmt::format("  dalembert::run_block<{}, Scalar>(lower, upper, {}, {}, {}, matrices, {});\n", elements, s.first_slot,
                        row, s.steps, end);
    for (size_t level = 0; level < levels.size(); ++level)
      if (levels[level].steps > 0)
        text += fmt::format(
            "  dalembert::run_cross_block<{8}, {0}, Scalar>(lower, upper, {1}, {2}, {3}_above_{4}_slot{7}, {5}, matrices, "
            "{6});\n",
            levels[level].steps, s.first_slot, row, s.name, level + 1, first_row(code, group, levels[level].limbs[0]), end,
            group.suffix, elements);
  }
  if (!with_base) return text;
  const auto base = [&](const char* what, int role, const std::string& matrix) {
    return s.width > 1 ? fmt::format("  dalembert::base_{}<{}, {}, Scalar>({}, {}, branches, {}, {});\n", what, s.limbs(),
                                     s.steps, kept(code, role, 0), stride(code), matrix, leading)
                       : fmt::format("  dalembert::run_base_{}<Scalar>({}, {}, {}, {}, {}, {}, {});\n", what,
                                     kept(code, role, 0), stride(code), s.first_slot, row, s.steps, matrix, leading);
  };
  text += "  // The base's rows and columns.\n";
  if (split) text += alone ? "  if (begin > 0) return;\n" : "  if (begin == 0) {\n";
  for (size_t i = 0; i < matrices.size(); ++i) {
    const std::string matrix = has_driven(code) ? fmt::format("matrices[{}]", i) : matrices[i];
    const ir::RolledPairs& roles = code.rolled.pairs[group.pairs[i]];
    text += base("columns", roles.columns, matrix);
    if (roles.rows >= 0) text += base("rows", roles.rows, matrix);
  }
  if (split && !alone) text += "  }\n";
  return text;
}

}  // namespace

std::string elements_stage(const CodeInput& code, size_t segment) {
  const ir::Segment& s = code.plan.segments[segment];
  const std::vector<PairsOfRows> groups = pairs_by_rows(code);
  std::string text;
  for (const PairsOfRows& group : groups) {
    if (!any_asked(group, s)) continue;
    const std::string own = elements_of_group(code, group, s, groups.size() == 1);
    text += groups.size() == 1 ? own : "  {\n" + own + "  }\n";
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

// Registers of long_limbs.hpp, lanes along a limb.
void long_limb_counts(const CodeInput& code, const PairsOfRows& group, const ir::Segment& s, const std::vector<Above>& levels,
                      int lanes, ElementCounts& counts) {
  const auto padded = [&](int rows) -> long {
    const int at_once = rows >= lanes ? lanes : std::max(2, std::min(lanes, 4));
    return rows <= 0 ? 0 : (rows + at_once - 1) / at_once * at_once;
  };
  std::vector<int> first, length;
  rows_of(code, group, limbs_asked(group, s), first, length);
  const int together = lanes == 8 ? 2 : 1;
  const auto each_columns = [&](int columns, const auto& f) {
    for (int k = 0; k < columns;) {
      const int some = k + together <= columns ? together : 1;
      f(k, some);
      k += some;
    }
  };
  for (size_t lane = 0; lane < length.size(); ++lane) {
    const int joints = length[lane];
    for (int tile = 0; tile < joints; tile += long_limb_tile) {
      const int rows = std::min(long_limb_tile, joints - tile), last = tile + rows;
      each_columns(joints, [&](int k, int some) {
        counts.above += some * padded(std::min(rows, k + some - tile));
        counts.below += some * padded(last - std::max(k + some, tile));
        if (some > 1 && k + 1 >= tile && k + 1 < last) counts.below += padded(1);
      });
    }
    for (const Above& a : levels) {
      const int above = static_cast<int>(a.limbs[lane].size());
      for (int tile = 0; tile < above; tile += long_limb_tile)
        counts.above += joints * padded(std::min(long_limb_tile, above - tile));
      for (int tile = 0; tile < joints; tile += long_limb_tile)
        counts.below += above * padded(std::min(long_limb_tile, joints - tile));
    }
  }
}

}  // namespace

ElementCounts element_counts(const CodeInput& code, size_t segment, const ir::Pairs& pairs, int lanes) {
  const ir::Segment& s = code.plan.segments[segment];
  ElementCounts counts;
  PairsOfRows group;
  for (const PairsOfRows& g : pairs_by_rows(code))
    for (const size_t number : g.pairs)
      if (&code.algorithm.pairs[number] == &pairs) group = g;
  if (!any_asked(group, s)) return counts;
  const std::vector<Above> levels = all_above(code, group, s);
  if (limb_after_limb(code, s)) {
    long_limb_counts(code, group, s, levels, lanes, counts);
    return counts;
  }
  if (s.width > 1) {
    tile_counts(s, levels, static_cast<int>(Products(code, group).lower.size()), pairs.symmetric, lanes, counts);
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
