#include "backend/emit_pairs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "backend/kept.hpp"
#include "backend/literals.hpp"

namespace dalembert::backend {
namespace {

const ir::OutputArray& array_of(const CodeInput& code, const ir::PairBlocks& matrices) {
  return code.algorithm.arrays[static_cast<size_t>(matrices.array)];
}
const ir::Pairs& pairs_of(const CodeInput& code, const ir::ElementSums& sums) {
  return code.algorithm.pairs[static_cast<size_t>(sums.pairs)];
}
const std::string& name_of(const CodeInput& code, const ir::ElementSums& sums) {
  return code.algorithm.arrays[static_cast<size_t>(pairs_of(code, sums).array)].name;
}
const ir::RolledPairs& base_roles(const CodeInput& code, const ir::ElementSums& sums) {
  return code.rolled.pairs[static_cast<size_t>(sums.pairs)];
}
bool with_base(const CodeInput& code, const ir::PairBlocks& matrices) {
  return base_roles(code, matrices.sums.front()).columns >= 0;
}

// f(matrices, suffix): the suffix is of names that are theirs.
template <class F>
void each_group(const CodeInput& code, const F& f) {
  for (size_t i = 0; i < code.rolled.blocks.size(); ++i)
    f(code.rolled.blocks[i], i == 0 ? std::string() : fmt::format("_{}", i + 1));
}

std::string sum_type(const std::vector<ir::FactorTerm>& terms) {
  std::vector<std::string> texts;
  for (const ir::FactorTerm& t : terms) texts.push_back(fmt::format("dalembert::Term<{}, {}>", t.lower, t.upper));
  return fmt::format("dalembert::Sum<{}>", fmt::join(texts, ", "));
}

std::string products_type(const ir::PairBlocks& matrices) {
  std::vector<std::string> kinds;
  for (const ir::ElementSums& s : matrices.sums)
    kinds.push_back(s.symmetric ? fmt::format("dalembert::Symmetric<{}>", sum_type(s.above))
                                : fmt::format("dalembert::Square<{}, {}>", sum_type(s.above), sum_type(s.below)));
  return fmt::format("dalembert::Matrices<{}>", fmt::join(kinds, ",\n                                   "));
}

std::string factors_text(const CodeInput& code, const std::string& name, const std::vector<ir::PairFactor>& factors) {
  std::vector<std::string> texts;
  for (const ir::PairFactor& f : factors) texts.push_back(kept(code, f.role, f.from));
  return fmt::format("  const dalembert::Factors<Scalar, {}> {}{{{{{}}}, {}}};\n", factors.size(), name, fmt::join(texts, ", "),
                     stride(code));
}

// Where the elements of a matrix go: to the result, and beside it what is of joints that follow others.
std::string matrix_text(const CodeInput& code, const ir::ElementSums& sums, const std::string& suffix) {
  const std::string& name = name_of(code, sums);
  return has_driven(code) ? fmt::format("{{workspace.{0}, scratch.mimic_{0}[0], coordinate{3}, {1}, {2}}}", name,
                                        expanded_rows(code), driven_joints(code), suffix)
                          : "workspace." + name;
}

// First rows and lengths of limbs.
std::string row_tables(const std::string& prefix, const std::vector<ir::LimbRows>& limbs, const std::string& suffix) {
  std::vector<int> rows, lengths;
  for (const ir::LimbRows& limb : limbs) rows.push_back(limb.row), lengths.push_back(limb.joints());
  return int_table(prefix + "_row" + suffix, rows) + int_table(prefix + "_length" + suffix, lengths);
}

// Limbs as the runtime takes long ones: where their slots are, and their rows.
std::string long_limb_table(const std::string& name, const std::vector<ir::LimbRows>& limbs) {
  std::vector<std::string> texts;
  for (const ir::LimbRows& limb : limbs)
    texts.push_back(fmt::format("{{{}, {}, {}, {}}}", limb.slot, limb.joints() > 1 ? limb.stride : 1, limb.row, limb.joints()));
  return fmt::format("constexpr dalembert::LongLimb {}[] = {{{}}};\n", name, fmt::join(texts, ", "));
}

// The function of blocks.hpp for the blocks between a segment and the limbs at one level above it, and how it is told where
// these stand.
struct Crossing {
  std::string function, type, slots;
};
Crossing crossing_of(const CodeInput& code, const ir::BlocksAbove& above, const std::string& slot_table) {
  switch (above.where) {
    case ir::BlocksAbove::Where::one:
      return {"shared_cross_blocks", "", fmt::format("{}, {}", above.one.slot, above.one.stride)};
    case ir::BlocksAbove::Where::lanes: {
      const ir::Segment& segment = code.plan.segments[static_cast<size_t>(above.segment)];
      return {"lane_cross_blocks", fmt::format(", dalembert::LanesAbove<{}, {}>", segment.width, fmt::join(above.lanes, ", ")),
              std::to_string(segment.first_slot)};
    }
    case ir::BlocksAbove::Where::slots: break;
  }
  return {"cross_blocks", "", slot_table};
}

// Of one group; `alone`: there is no other.
std::string elements_of_group(const CodeInput& code, const ir::PairBlocks& matrices, const std::string& suffix, size_t segment,
                              bool alone) {
  const ir::Segment& s = code.plan.segments[segment];
  const ir::SegmentBlocks& blocks = matrices.segments[segment];
  std::vector<std::string> names, equations;
  for (const ir::ElementSums& sums : matrices.sums) {
    names.push_back(matrix_text(code, sums, suffix));
    equations.push_back(pairs_of(code, sums).equation);
  }
  std::string text = fmt::format("  // {}\n", fmt::join(equations, ". "));
  text += factors_text(code, "lower", matrices.lower) + factors_text(code, "upper", matrices.upper);
  text += fmt::format("  {} matrices[] = {{{}}};\n", has_driven(code) ? "const dalembert::Reduced<Scalar>" : "Scalar* const",
                      fmt::join(names, ", "));
  const ir::OutputArray& array = array_of(code, matrices);
  const std::string leading = array.is_part() ? std::to_string(array.rows) : "nv", elements = "Elements" + suffix;
  const bool split = s.splits_columns();
  const std::string end = leading + (split ? ", begin, end" : fmt::format(", 0, {}", s.steps));
  const int row = blocks.limbs[0].row;
  const auto above_name = [&](size_t level) { return fmt::format("{}_above_{}", s.name, level + 1); };
  const auto each_above = [&](const auto& f) {
    for (size_t level = 0; level < blocks.above.size(); ++level)
      if (blocks.above[level].steps > 0) f(level, blocks.above[level]);
  };
  if (s.width > 1 && (with_base(code, matrices) || !s.limb_after_limb))
    text += fmt::format("  constexpr dalembert::BranchTable branches{{{0}_row{2}, {0}_length{2}, {1}}};\n", s.name,
                        s.first_slot, suffix);
  if (s.limb_after_limb) {
    const std::string limbs = s.name + "_branches" + suffix;
    text += fmt::format("  dalembert::long_limb_blocks<{}, Scalar>(lower, upper, {}, {}, matrices, {});\n", elements, limbs,
                        s.bodies.size(), end);
    each_above([&](size_t level, const ir::BlocksAbove&) {
      text += fmt::format("  dalembert::long_limb_cross_blocks<{}, Scalar>(lower, upper, {}, {}{}, {}, matrices, {});\n",
                          elements, limbs, above_name(level), suffix, s.bodies.size(), end);
    });
  } else if (s.width > 1) {
    text += fmt::format("  dalembert::branch_blocks<{}, {}, {}, Scalar>(lower, upper, branches, matrices, {});\n", elements,
                        s.limbs(), s.steps, end);
    each_above([&](size_t level, const ir::BlocksAbove& above) {
      const Crossing crossing = crossing_of(code, above, above_name(level) + "_slot" + suffix);
      text += fmt::format(
          "  constexpr dalembert::BranchTable above_{1}{{{0}_row{9}, {0}_length{9}, 0}};\n"
          "  dalembert::{2}<{10}, {3}, {4}, {5}, Scalar{6}>(lower, upper, branches, {7}, above_{1}, matrices, {8});\n",
          above_name(level), level + 1, crossing.function, s.limbs(), s.steps, above.steps, crossing.type, crossing.slots, end,
          suffix, elements);
    });
  } else {
    text += fmt::format("  dalembert::run_block<{}, Scalar>(lower, upper, {}, {}, {}, matrices, {});\n", elements, s.first_slot,
                        row, s.steps, end);
    each_above([&](size_t level, const ir::BlocksAbove& above) {
      text += fmt::format("  dalembert::run_cross_block<{}, {}, Scalar>(lower, upper, {}, {}, {}_slot{}, {}, matrices, {});\n",
                          elements, above.steps, s.first_slot, row, above_name(level), suffix, above.limbs[0].row, end);
    });
  }
  if (!with_base(code, matrices)) return text;
  const auto base = [&](const char* what, int role, const std::string& matrix) {
    return s.width > 1 ? fmt::format("  dalembert::base_{}<{}, {}, Scalar>({}, {}, branches, {}, {});\n", what, s.limbs(),
                                     s.steps, kept(code, role, 0), stride(code), matrix, leading)
                       : fmt::format("  dalembert::run_base_{}<Scalar>({}, {}, {}, {}, {}, {}, {});\n", what,
                                     kept(code, role, 0), stride(code), s.first_slot, row, s.steps, matrix, leading);
  };
  text += "  // The base's rows and columns.\n";
  if (split) text += alone ? "  if (begin > 0) return;\n" : "  if (begin == 0) {\n";
  for (size_t i = 0; i < names.size(); ++i) {
    const std::string matrix = has_driven(code) ? fmt::format("matrices[{}]", i) : names[i];
    const ir::RolledPairs& roles = base_roles(code, matrices.sums[i]);
    text += base("columns", roles.columns, matrix);
    if (roles.rows >= 0) text += base("rows", roles.rows, matrix);
  }
  if (split && !alone) text += "  }\n";
  return text;
}

}  // namespace

std::string pairs_types(const CodeInput& code) {
  std::string text;
  each_group(code, [&](const ir::PairBlocks& matrices, const std::string& suffix) {
    text += "\n";
    for (const ir::ElementSums& sums : matrices.sums)
      text += fmt::format("// {}: {}\n", name_of(code, sums), pairs_of(code, sums).equation);
    text += fmt::format("using Elements{} = {};\n", suffix, products_type(matrices));
  });
  return text;
}

std::string limb_tables(const CodeInput& code, size_t segment) {
  const ir::Segment& s = code.plan.segments[segment];
  std::string text;
  each_group(code, [&](const ir::PairBlocks& matrices, const std::string& suffix) {
    const ir::SegmentBlocks& blocks = matrices.segments[segment];
    if (blocks.empty()) return;
    const auto each_above = [&](const auto& f) {
      for (size_t level = 0; level < blocks.above.size(); ++level)
        if (blocks.above[level].steps > 0) f(fmt::format("{}_above_{}", s.name, level + 1), blocks.above[level]);
    };
    if (s.limb_after_limb) {
      text += long_limb_table(s.name + "_branches" + suffix, blocks.limbs);
      each_above(
          [&](const std::string& name, const ir::BlocksAbove& above) { text += long_limb_table(name + suffix, above.limbs); });
    }
    if (s.width > 1 && (with_base(code, matrices) || !s.limb_after_limb)) text += row_tables(s.name, blocks.limbs, suffix);
    if (s.limb_after_limb) return;
    each_above([&](const std::string& name, const ir::BlocksAbove& above) {
      if (above.where == ir::BlocksAbove::Where::slots) text += int_table(name + "_slot" + suffix, above.slots_of);
      if (s.width > 1) text += row_tables(name, above.limbs, suffix);
    });
  });
  return text;
}

std::string elements_stage(const CodeInput& code, size_t segment) {
  const bool alone = code.rolled.blocks.size() == 1;
  std::string text;
  each_group(code, [&](const ir::PairBlocks& matrices, const std::string& suffix) {
    if (matrices.segments[segment].empty()) return;
    const std::string own = elements_of_group(code, matrices, suffix, segment, alone);
    text += alone ? own : "  {\n" + own + "  }\n";
  });
  return text;
}

std::string following_tables(const CodeInput& code) {
  std::string text;
  each_group(code, [&](const ir::PairBlocks& matrices, const std::string& suffix) {
    const ir::FollowingRows& following = matrices.following;
    if (following.row.empty()) return;
    text +=
        "// Rows of the base and of every joint in the matrices; -1, -2, ... for mimic joints, which are added to those of "
        "the joints they follow.\n" +
        int_table("coordinate" + suffix, following.row);
    if (!following.to.empty())
      text += int_table("mimic_from" + suffix, following.from) + int_table("mimic_to" + suffix, following.to);
  });
  return text;
}

std::string following_statements(const CodeInput& code) {
  std::string text;
  each_group(code, [&](const ir::PairBlocks& matrices, const std::string& suffix) {
    const ir::FollowingRows& following = matrices.following;
    for (const ir::ElementSums& sums : matrices.sums)
      if (!following.to.empty())
        text +=
            fmt::format("  dalembert::add_mimic(scratch.mimic_{0}[0], mimic_from{3}, mimic_to{3}, {1}, {2}, workspace.{0});\n",
                        name_of(code, sums), following.set, following.to.size(), suffix);
  });
  return (text.empty() ? "" : "  // Rows and columns of mimic joints are added to those of the joints they follow.\n") + text;
}

}  // namespace dalembert::backend
