#include "backend/emit_rolled.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <optional>

#include "backend/code_text.hpp"
#include "backend/emit_pairs.hpp"
#include "backend/emit_paragraph.hpp"
#include "backend/emit_prepare.hpp"
#include "backend/emit_projections.hpp"
#include "backend/graph_printer.hpp"
#include "backend/kept.hpp"
#include "backend/kernel_text.hpp"
#include "backend/literals.hpp"
#include "backend/templates.hpp"

namespace dalembert::backend {
namespace {

using ir::InputKind;

std::string layout(const CodeInput& code) {
  std::string text = "// Branches side by side in lanes; slot = first + step * width + lane.\n";
  for (const ir::Segment& s : code.plan.segments) {
    text += fmt::format("//   {}: {} steps, {} lane{}, slots {} to {}\n", s.name, s.steps, s.width, s.width > 1 ? "s" : "",
                        s.first_slot, s.first_slot + s.slots() - 1);
    for (int lane = 0; lane < s.width; ++lane) {
      const auto& bodies = s.bodies[static_cast<size_t>(lane)];
      const auto last = std::find_if(bodies.rbegin(), bodies.rend(), [](int b) { return b >= 0; });
      if (last == bodies.rend()) continue;
      text += comment_text(fmt::format("//     lane {}: {} to {}", lane,
                                       code.tree.bodies[static_cast<size_t>(bodies.front())].joint,
                                       code.tree.bodies[static_cast<size_t>(*last)].joint)) +
              "\n";
    }
  }
  return text + fmt::format("[[maybe_unused]] constexpr int base_slot = {};  // of {}\n", code.plan.root_slot,
                            comment_text(code.tree.base_link));
}

// What the base computes at one of its stages.
std::string base_statements(const CodeInput& code, const ir::BaseStage& stage) {
  std::vector<Sink> sinks;
  for (const auto& [to, node] : stage.stores) sinks.push_back({node, number(code, to) + " = ", ";"});
  for (const ir::BlockElement& e : stage.elements) {
    const ir::OutputArray& a = code.algorithm.arrays[static_cast<size_t>(e.array)];
    sinks.push_back({e.node,
                     fmt::format("{}workspace.{}[{}] = ", code.plan.sweeps_apart ? "if (results) " : "", a.name,
                                 element_index(a, e.row, e.column)),
                     ";"});
  }
  PrintStyle style;
  style.type = "Scalar";
  style.scalar = code.scene.scalar;
  style.input = [&](const ir::Input& in) {
    return in.kind == InputKind::kept ? number(code, address(in)) : input_text(code, in);
  };
  std::string text = "  // The base";
  for (size_t i = 0; i < stage.equations.size(); ++i) text += (i == 0 ? ": " : "\n  // ") + stage.equations[i];
  return text + "\n" + print(stage.graph, sinks, style);
}

bool is_of_state(InputKind kind) {
  return kind == InputKind::position || kind == InputKind::velocity || kind == InputKind::acceleration ||
         kind == InputKind::effort;
}

bool reads_state(const ir::BaseStage& stage) {
  bool any = false;
  ir::each_input(stage.graph, stage.roots(), [&](const ir::Input& in) { any = any || is_of_state(in.kind); });
  return any;
}

// Roles of joints that are results: copied to their rows or columns, a driven joint's added to its driver's.
std::string joint_results(const CodeInput& code) {
  std::string text;
  std::vector<std::string> of_all;
  for (const ir::JointResult& joints : code.rolled.results) {
    if (!joints.copied) continue;
    const ir::Result& r = code.algorithm.results[static_cast<size_t>(joints.result)];
    const ir::OutputArray& array = code.algorithm.arrays[static_cast<size_t>(r.array)];
    if (!joints.whole) {
      for (const auto& [at, from, first] : joints.elements)
        text += fmt::format("  workspace.{}[{}] {} {};\n", array.name, at, first ? "=" : "+=", number(code, from));
      continue;
    }
    const int components = code.rolled.roles[static_cast<size_t>(r.role)].components(),
              step = r.layout == ir::Layout::columns ? array.rows : 1;
    const std::string row = fmt::format("{} + k", base_rows(code));
    for (int i = 0; i < components; ++i)
      of_all.push_back(fmt::format("workspace.{}[{}] = {}[joint_slot[k]];\n", array.name,
                                   step == 1 ? row : fmt::format("{} * ({}) + {}", step, row, r.from + i),
                                   kept(code, r.role, i)));
  }
  if (of_all.empty()) return text;
  const std::string each = fmt::format("{}", fmt::join(of_all, "    "));
  constexpr size_t few = 64;  // beyond which looking slots up costs less than fetching the text
  if (static_cast<size_t>(code.tree.joints()) * of_all.size() <= few)
    return text + fmt::format("  dalembert::each_constant<{}>([&](auto k) DALEMBERT_IN_BLOCK {{\n    {}  }});\n",
                              code.tree.joints(), each);
  return text + fmt::format("  for (int k = 0; k < {}; ++k) {{\n    {}  }}\n", code.tree.joints(), each);
}

bool joint_loops(const CodeInput& code) {
  return std::any_of(code.rolled.results.begin(), code.rolled.results.end(),
                     [](const ir::JointResult& joints) { return joints.whole; });
}

bool checked_at_base(const CodeInput& code) {
  return std::any_of(code.rolled.base.begin(), code.rolled.base.end(), [](const ir::BaseStage& b) { return b.checks_pivots; });
}

// Of dalembert::JointSlots.
std::string slots_of_joints(const CodeInput& code) {
  const ir::PivotRoles& in_slots = *code.rolled.pivots_in_slots;
  const auto at = [&](int role) { return is_kept(code, role) ? kept(code, role, 0) : "nullptr"; };
  return fmt::format("{}, {}, no_joint, {}, {}, {}, {}, joint_slot", at(in_slots.pivot), at(in_slots.diagonal),
                     at(in_slots.gain), at(in_slots.linear), at(in_slots.angular), stride(code));
}

std::string status_of_slots(const CodeInput& code) {
  return fmt::format("  const dalembert::JointSlots<Scalar> slots_of_joints{{{}}};\n", slots_of_joints(code)) +
         status_statement(
             code, fmt::format("factor_status_of_slots<nv, {}, {}>(slots_of_joints, ", base_rows(code), code.plan.slots));
}

std::string pivots_statements(const CodeInput& code) {
  if (!code.rolled.pivots_in_slots) return guard_statements(code);
  return (checked_at_base(code) ? "" : status_of_slots(code)) + clear_statements(code);
}

std::string pivots_table(const CodeInput& code) {
  if (!code.rolled.pivots_in_slots) return "";
  std::vector<int> none(static_cast<size_t>(code.plan.slots), 1);
  for (int k = 0; k < code.tree.joints(); ++k) none[static_cast<size_t>(slot_of(code, k))] = 0;
  std::vector<std::string> texts;
  for (const int x : none) texts.push_back(literal(x, code.scene.scalar));
  return fmt::format("alignas(64) constexpr Scalar no_joint[] = {{\n    {}}};\n", wrapped(texts, 4));
}

std::string limbs_type(const CodeInput& code) {
  std::string slots;
  for (int k = 0; k < code.tree.joints(); ++k) slots += fmt::format(", {}", slot_of(code, k));
  return fmt::format("dalembert::LimbsInSlots<Scalar, {}, {}{}>", base_rows(code), stride(code), slots);
}

// Along which joints feel what constraints bear; empty: by an array.
std::string axes_of_slots(const CodeInput& code) {
  const std::optional<ir::AxesRoles>& axes = code.rolled.axes_in_slots;
  if (!axes) return "";
  return fmt::format("  const {} axes{{nullptr, nullptr, {}, {}, nullptr, nullptr}};\n", limbs_type(code),
                     kept(code, axes->linear, 0), kept(code, axes->angular, 0));
}

// By which rows of constraints go up; empty: by arrays.
std::string limbs_in_slots(const CodeInput& code) {
  const std::vector<ir::Kernel>& kernels = code.algorithm.kernels;
  const auto first = std::find_if(kernels.begin(), kernels.end(), [](const ir::Kernel& k) { return k.by_limbs(); });
  if (first == kernels.end() || !code.rolled.pivots_in_slots) return "";
  const ir::Kernel& kernel = *first;
  const auto name = [&](int array) { return code.algorithm.arrays[static_cast<size_t>(array)].name; };
  const ir::PivotRoles& in_slots = *code.rolled.pivots_in_slots;
  const auto at = [&](int role) { return kept(code, role, 0); };
  return fmt::format("  const {} branches{{\n      {}, {}, {}, {},\n      workspace.{}, workspace.{}}};\n", limbs_type(code),
                     at(in_slots.pivot), at(in_slots.gain), at(in_slots.linear), at(in_slots.angular),
                     name(kernel[ir::Operand::gain]), name(kernel[ir::Operand::pivots]));
}

std::string results_statements(const CodeInput& code) {
  std::string text = following_statements(code) + joint_results(code);
  for (const ir::AddedConstant& a : code.rolled.added) {
    const ir::OutputArray& array = code.algorithm.arrays[static_cast<size_t>(a.array)];
    const auto index = element_index(array, a.row, a.column);
    if (a.role >= 0)
      text += fmt::format("  workspace.{}[{}] {}= {}[{}];  // between axes of one joint\n", array.name, index,
                          a.value > 0 ? "+" : "-", kept(code, a.role, 0), slot_of(code, a.body));
    else
      text += fmt::format("  workspace.{}[{}] += {};  // added on the diagonal\n", array.name, index,
                          literal(a.value, code.scene.scalar));
  }
  return text + projection_statements(code) + kernel_statements(code, limbs_in_slots(code), axes_of_slots(code)) +
         pivots_statements(code);
}

// What a stage's function does with what not every stage takes.
std::string scratch_statements(const CodeInput& code, const Stage& stage) {
  if (!code.plan.sweeps_apart)
    return fmt::format("  Workspace::{}& scratch = workspace.{};\n  static_cast<void>(scratch);\n", own_type(code, "Scratch"),
                       own_name(code, "scratch"));
  return fmt::format("  static_cast<void>(scratch), static_cast<void>(workspace){};\n",
                     stage.kind == Stage::Kind::base ? ", static_cast<void>(results)" : "");
}

std::string tables_text(const CodeInput& code) {
  std::string text = prepare_tables(code);
  std::vector<int> slots;
  for (int k = 0; k < code.tree.joints(); ++k) slots.push_back(slot_of(code, k));
  if (joint_loops(code)) text += int_table("joint_slot", slots);
  text += pivots_table(code);
  text += following_tables(code);
  for (size_t s = 0; s < code.plan.segments.size(); ++s)
    text += "\n// " + code.plan.segments[s].name + ", a row per step, a column per lane\n" + segment_tables(code, s) +
            limb_tables(code, s);
  return text + pairs_types(code);
}

}  // namespace

std::vector<Stage> rolled_stages(const CodeInput& code) {
  std::vector<Stage> all;
  const auto& segments = code.plan.segments;
  const auto numbered = [](const std::string& name, int round) {
    return round == 0 ? name : fmt::format("{}_{}", name, round + 1);
  };
  const int last = code.rolled.levels() - 1;
  for (int level = 0; level <= last; ++level) {
    std::string base = level == 0 ? prepare_statements(code) : "";
    bool state = level == 0 && (prepare_reads_q(code) || prepare_spreads(code));
    for (const ir::BaseStage& b : code.rolled.base) {
      if (b.level != level) continue;
      base += base_statements(code, b);
      if (b.checks_pivots) base += status_of_slots(code);
      state = state || reads_state(b);
    }
    if (!base.empty())
      all.push_back({Stage::Kind::base, level, -1, level == 0 ? "prepare" : numbered("base", level / 2 - 1), state, base});
    for (size_t i = 0; i < segments.size(); ++i) {
      const size_t s = level % 2 == 0 ? i : segments.size() - 1 - i;
      std::string body;
      for (const ir::SegmentStage& stage : code.rolled.segments[s].stages)
        for (const ir::Paragraph& p : stage.paragraphs)
          if (stage.level == level) body += paragraph_text(code, s, p);
      const std::string direction = numbered(level % 2 == 0 ? "outwards" : "inwards", level / 2);
      if (!body.empty())
        all.push_back({Stage::Kind::segment, level, static_cast<int>(s), direction + "_" + segments[s].name, false, body});
    }
  }
  if (!code.algorithm.pairs.empty())
    for (size_t s = 0; s < segments.size(); ++s)
      if (std::string body = elements_stage(code, s); !body.empty())
        all.push_back(
            {Stage::Kind::elements, last, static_cast<int>(s), "elements_" + segments[s].name, false, std::move(body)});
  if (const std::string body = results_statements(code); !body.empty())
    all.push_back({Stage::Kind::results, last, -1, "results", false, body});
  return all;
}

int checked_pivots(const CodeInput& code) {
  const std::optional<ir::Guard>& guard = code.algorithm.guard;
  if (!guard || guard->pivots < 0) return 0;
  return code.rolled.pivots_in_slots ? base_rows(code) + code.plan.slots
                                     : code.algorithm.arrays[static_cast<size_t>(guard->pivots)].rows;
}

std::vector<std::string> rolled_includes(const CodeInput& code) {
  const bool lanes =
      std::any_of(code.plan.segments.begin(), code.plan.segments.end(), [](const auto& s) { return s.width > 1; });
  const bool alone =
      std::any_of(code.plan.segments.begin(), code.plan.segments.end(), [](const auto& s) { return s.width == 1; });
  const bool pairs = !code.algorithm.pairs.empty();
  std::vector<std::string> headers;
  if (pairs && lanes) headers.emplace_back("blocks");
  if (pairs && alone) headers.emplace_back("runs");
  if (pairs &&
      std::any_of(code.plan.segments.begin(), code.plan.segments.end(), [](const ir::Segment& s) { return s.limb_after_limb; }))
    headers.emplace_back("long_limbs");
  if (projects_by_rows(code)) headers.emplace_back("projections");
  if (prepare_reads_q(code)) headers.emplace_back("sincos");
  if (solves(code)) headers.emplace_back("solve");
  for (const std::string& header : kernel_includes(code)) headers.push_back(header);
  if (headers.empty()) headers.emplace_back("lanes");
  return headers;
}

bool can_sweep_apart(const CodeInput& code) {
  return code.is_rolled() && !code.next && !code.algorithm.pairs.empty() && !has_driven(code) && !checked_at_base(code);
}

std::string arguments_of(const CodeInput& code, const Stage& stage) {
  std::string text = stage.reads_state ? parameters_of(code) + ", " : "";
  if (code.plan.sweeps_apart) text += fmt::format("Workspace::{}& scratch, ", own_type(code, "Scratch"));
  text += "Workspace& workspace";
  if (code.plan.sweeps_apart && stage.kind == Stage::Kind::base) text += ", bool results";
  if (stage.kind == Stage::Kind::elements && code.plan.segments[static_cast<size_t>(stage.segment)].splits_columns())
    text += ", int begin, int end";
  return text;
}

std::string call_of(const CodeInput& code, const Stage& stage) {
  std::string text = stage.reads_state ? arguments_of(code) + ", " : "";
  if (code.plan.sweeps_apart) text += "workspace." + own_name(code, "scratch") + ", ";
  text += "workspace";
  if (code.plan.sweeps_apart && stage.kind == Stage::Kind::base) text += ", true";
  if (stage.kind != Stage::Kind::elements) return text;
  const ir::Segment& s = code.plan.segments[static_cast<size_t>(stage.segment)];
  return s.splits_columns() ? fmt::format("{}, 0, {}", text, s.columns()) : text;
}

std::string rolled_source(const CodeInput& code, const Symbol& symbol) {
  // The names of another function's tables and stages may be the same: evaluate() has its own where the reader looks first. A
  // function that the scene names may be called as one of them.
  const bool first = function_of(code).is_evaluate() && code.scene.functions.empty(), scoped = code.plan.tasks || !first;
  const std::string scope = own_name(code, "stages");
  std::string unused, text, calls;
  for (const std::string& vector : vectors_of(code))
    unused += fmt::format("{}static_cast<void>({})", unused.empty() ? "  " : ", ", vector);
  bool state = false;
  for (const Stage& s : rolled_stages(code)) {
    // A stage's function has the same head whatever its body needs of it.
    text += fmt::format("{}void {}({}) noexcept {{\n{}{}{}}}\n\n", code.plan.tasks ? "" : "static ", s.name,
                        arguments_of(code, s), s.reads_state ? unused + ";\n" : "", scratch_statements(code, s), s.body);
    calls += fmt::format("  {}{}({});\n", scoped ? scope + "::" : "", s.name, call_of(code, s));
    state = state || s.reads_state;
  }
  calls += next_section_call(code);
  if (calls.empty()) unused += ", static_cast<void>(workspace)";
  if (!state) calls = unused + ";\n" + calls;
  const std::string open = "namespace " + scope + " {\n\n";
  return render("rolled.cpp", {{"open", first ? "" : open},
                               {"linkage", symbol.linkage},
                               {"function", symbol.name},
                               {"parameters", parameters_of(code)},
                               {"layout", layout(code)},
                               {"tables", tables_text(code)},
                               {"stages_open", scoped && first ? open : ""},
                               {"stages", text},
                               {"stages_close", scoped ? "}  // namespace " + scope + "\n\n" : ""},
                               {"calls", calls}});
}

}  // namespace dalembert::backend
