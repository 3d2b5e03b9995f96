#include "backend/emit_blocks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "backend/emit_paragraph.hpp"
#include "backend/literals.hpp"

namespace dalembert::backend {
namespace {

int base_rows(const CodeInput& code) { return code.tree.floating_base ? 6 : 0; }

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

std::string ints(const std::string& name, const std::vector<int>& values) {
  std::vector<std::string> texts;
  for (int x : values) texts.push_back(std::to_string(x));
  return fmt::format("constexpr int {}[] = {{{}{}}};\n", name, texts.size() > 16 ? "\n    " : "", wrapped(texts, 4));
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

}  // namespace

bool elements_split(const ir::Segment& segment) { return segment.steps > 8; }

std::string limb_tables(const CodeInput& code, size_t segment) {
  if (!code.rolled.mass && !code.rolled.coriolis) return "";
  const ir::Segment& s = code.plan.segments[segment];
  std::string text;
  std::vector<int> first, length;
  rows_of(code, s.bodies, first, length);
  if (s.width > 1) text += ints(s.name + "_row", first) + ints(s.name + "_length", length);
  const std::vector<Above> levels = all_above(code, s);
  for (size_t level = 0; level < levels.size(); ++level) {
    const Above& a = levels[level];
    std::vector<int> above_first, above_length, slots;
    rows_of(code, a.limbs, above_first, above_length);
    for (size_t step = 0; step < a.steps; ++step)
      for (const auto& limb : a.limbs) slots.push_back(step < limb.size() ? slot_of(code, limb[step]) : slot_of(code, -1));
    const std::string prefix = fmt::format("{}_above_{}", s.name, level + 1);
    if (s.width == 1 || a.shared().empty()) text += ints(prefix + "_slot", slots);
    if (s.width > 1) text += ints(prefix + "_row", above_first) + ints(prefix + "_length", above_length);
  }
  return text;
}

std::string elements_stage(const CodeInput& code, size_t segment) {
  const ir::Segment& s = code.plan.segments[segment];
  const bool mass = code.rolled.mass, coriolis = code.rolled.coriolis, floating = code.tree.floating_base;
  const char* elements = mass && coriolis ? "both" : mass ? "mass" : "coriolis";
  const std::string M = mass ? "workspace.mass_matrix" : "static_cast<Scalar*>(nullptr)",
                    C = coriolis ? "workspace.coriolis_matrix" : "static_cast<Scalar*>(nullptr)";
  const std::string angular = code.rolled.all_revolute ? "kept.rotation[6]" : "kept.joint_angular[0]";
  const auto if_coriolis = [&](const char* role) { return coriolis ? kept(code, role, 0) : "nullptr"; };
  std::string text = "  // Phase III: M_ik = F_k.J_i, C_ik = G_k.J_i, C_ki = F_k.dJ_i + H_k.J_i\n";
  text += fmt::format("  const dalembert::Panels<Scalar> panels{{kept.joint_linear[0], {}, {}, {}, {}, {}, {}}};\n", angular,
                      if_coriolis("joint_rate"), kept(code, "inertia_force", 0), if_coriolis("bias_force"),
                      if_coriolis("transposed"), code.plan.slots + 8);
  const std::vector<Above> levels = all_above(code, s);
  const std::string end = elements_split(s) ? "nv, begin, end" : fmt::format("nv, 0, {}", s.steps);
  if (s.width > 1) {
    text += fmt::format("  constexpr dalembert::LimbTable limbs{{{0}_row, {0}_length, {1}}};\n", s.name, s.first_slot);
    text += fmt::format("  dalembert::limb_blocks<dalembert::Elements::{}, {}, {}, Scalar>(panels, limbs, {}, {}, {});\n",
                        elements, s.width, s.steps, M, C, end);
    for (size_t level = 0; level < levels.size(); ++level) {
      const std::vector<int> one = levels[level].shared();
      const int first = one.empty() ? 0 : slot_of(code, one.front());
      const std::string where = one.empty()       ? fmt::format("{}_above_{}_slot", s.name, level + 1)
                                : one.size() == 1 ? fmt::format("{}, 0", first)
                                                  : fmt::format("{}, {}", first, slot_of(code, one[1]) - first);
      text += fmt::format(
          "  constexpr dalembert::LimbTable above_{3}{{{0}_above_{3}_row, {0}_above_{3}_length, 0}};\n"
          "  dalembert::{9}cross_blocks<dalembert::Elements::{1}, {2}, {8}, {4}, Scalar>(panels, limbs, {10}, above_{3}, {5}, "
          "{6}, {7});\n",
          s.name, elements, s.width, level + 1, levels[level].steps, M, C, end, s.steps, one.empty() ? "" : "shared_", where);
    }
  } else {
    const int row = base_rows(code) + s.bodies[0].front();
    text += fmt::format("  dalembert::run_block<dalembert::Elements::{}, Scalar>(panels, {}, {}, {}, {}, {}, {});\n", elements,
                        s.first_slot, row, s.steps, M, C, end);
    for (size_t level = 0; level < levels.size(); ++level)
      text += fmt::format(
          "  dalembert::run_cross_block<dalembert::Elements::{}, {}, Scalar>(panels, {}, {}, {}_above_{}_slot, {}, {}, {}, "
          "{});\n",
          elements, levels[level].steps, s.first_slot, row, s.name, level + 1, base_rows(code) + levels[level].limbs[0].front(),
          M, C, end);
  }
  if (!floating) return text;
  const auto base = [&](const char* what, const char* force, const std::string& matrix) {
    return s.width > 1
               ? fmt::format("  dalembert::base_{}<{}, {}, Scalar>({}, panels.stride, limbs, {}, nv);\n", what, s.width,
                             s.steps, kept(code, force, 0), matrix)
               : fmt::format("  dalembert::run_base_{}<Scalar>({}, panels.stride, {}, {}, {}, {}, nv);\n", what,
                             kept(code, force, 0), s.first_slot, base_rows(code) + s.bodies[0].front(), s.steps, matrix);
  };
  text += "  // The base's rows and columns.\n";
  if (elements_split(s)) text += "  if (begin > 0) return;\n";
  if (mass) text += base("columns", "inertia_force", M) + base("rows", "inertia_force", M);
  if (coriolis) text += base("columns", "bias_force", C) + base("rows", "below_force", C);
  return text;
}

std::string wrench_tables(const CodeInput& code) {
  if (!code.rolled.wrench) return "";
  std::vector<int> parents;
  std::string rotations, translations;
  for (size_t k = 0; k < code.normal.bodies.size(); ++k) {
    const ir::NormalBody& n = code.normal.bodies[k];
    parents.push_back(n.parent);
    std::vector<std::string> r, t;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) r.push_back(literal(n.link_rotation(i, j), code.scene.scalar));
      t.push_back(literal(n.link_translation[i], code.scene.scalar));
    }
    rotations += fmt::format("    {{{}}},\n", fmt::join(r, ", "));
    translations += fmt::format("    {{{}}},\n", fmt::join(t, ", "));
  }
  return ints("body_parent", parents) + "constexpr Scalar link_rotation[][9] = {\n" + rotations +
         "};\nconstexpr Scalar link_translation[][3] = {\n" + translations + "};\n";
}

std::string wrench_stage(const CodeInput& code) {
  return fmt::format(
      "  const dalembert::BodyTable<Scalar> table{{joint_slot, body_parent, link_rotation, link_translation}};\n"
      "  dalembert::wrench_columns<Scalar>(table, {}, kept.rotation[0], kept.position[0], kept.joint_linear[0], {}, {}, {},\n"
      "                                    workspace.wrench_influence, nv);\n",
      code.tree.joints(), code.rolled.all_revolute ? "kept.rotation[6]" : "kept.joint_angular[0]", code.plan.slots + 8,
      base_rows(code));
}

}  // namespace dalembert::backend
