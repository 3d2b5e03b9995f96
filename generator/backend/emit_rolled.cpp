#include "backend/emit_rolled.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "backend/code_text.hpp"
#include "backend/emit_blocks.hpp"
#include "backend/emit_paragraph.hpp"
#include "backend/emit_straight.hpp"
#include "backend/graph_printer.hpp"
#include "backend/literals.hpp"
#include "backend/templates.hpp"

namespace dalembert::backend {
namespace {

using ir::Direction;

const char* const open_stage = "  Kept& kept = workspace.kept;\n";

int stride(const CodeInput& code) { return code.plan.slots + 8; }  // with room for the root's slot and to read past the last

bool kept_role(const CodeInput& code, std::string_view name) {
  return std::any_of(code.rolled.roles.begin(), code.rolled.roles.end(), [&](const ir::Role& r) { return r.name == name; });
}

// `static constexpr int name[] = {…};`
std::string int_table(const std::string& name, const std::vector<int>& values) {
  std::vector<std::string> texts;
  for (int x : values) texts.push_back(std::to_string(x));
  return fmt::format("constexpr int {}[] = {{\n    {}}};\n", name, wrapped(texts, 4));
}

std::string layout(const CodeInput& code) {
  std::string text = "// Limbs side by side in lanes; slot = first + step * width + lane.\n";
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
  return text;
}

// The joint of every slot; where a lane has no body left, its last joint's.
std::vector<int> joints_of_slots(const CodeInput& code) {
  std::vector<int> joints(static_cast<size_t>(code.plan.slots), 0);
  for (const ir::Segment& s : code.plan.segments)
    for (int lane = 0; lane < s.width; ++lane) {
      int last = 0;
      for (int step = 0; step < s.steps; ++step) {
        const int body = s.bodies[static_cast<size_t>(lane)][static_cast<size_t>(step)];
        if (body >= 0) last = body;
        joints[static_cast<size_t>(s.first_slot + step * s.width + lane)] = last;
      }
    }
  return joints;
}

// The slots of the joints that the arrays of positions and rates are spread to.
// Only those that the code reads.
std::string joint_tables(const CodeInput& code, const std::string& text) {
  std::vector<int> all, turning, turning_at, sliding, sliding_at;
  for (int k = 0; k < code.tree.joints(); ++k) {
    all.push_back(slot_of(code, k));
    const bool slides = code.tree.bodies[static_cast<size_t>(k)].prismatic();
    (slides ? sliding : turning).push_back(slot_of(code, k));
    (slides ? sliding_at : turning_at).push_back(k);
  }
  std::string tables;
  const auto add = [&](const std::string& name, const std::vector<int>& values) {
    if (text.find(name) != std::string::npos) tables += int_table(name, values);
  };
  add("joint_slot", all);
  add("slot_joint", joints_of_slots(code));
  add("sliding_slot", sliding);
  add("sliding_joint", sliding_at);
  add("turning_slot", turning);
  add("turning_joint", turning_at);
  return tables;
}

class Prepare {
 public:
  explicit Prepare(const CodeInput& code) : code_(code) {
    for (const ir::Body& b : code.tree.bodies) (b.prismatic() ? sliding_ : turning_)++;
    for (int k = 0; k < code.tree.joints(); ++k)
      if (code.tree.carries_reference(static_cast<size_t>(k))) held_.push_back(k);
  }

  std::string body() const {
    const int base_q = code_.tree.floating_base ? 7 : 0, base_v = code_.tree.floating_base ? 6 : 0;
    std::string text = open_stage;
    const bool own = kept_role(code_, "sine") || kept_role(code_, "cosine");
    const bool pose = kept_role(code_, "pose_sine") || kept_role(code_, "pose_cosine");
    if (own) text += sines("", base_q, false);
    if (pose) text += own ? copy_of_sines() : sines("pose_", base_q, true) + held_at_zero();
    if (kept_role(code_, "slide")) text += spread("slide", "sliding", "q", base_q, false);
    if (kept_role(code_, "pose_slide")) text += spread("pose_slide", "sliding", "q", base_q, true);
    if (kept_role(code_, "rate") && sliding_ == 0)
      text += fmt::format(
          "  for (int i = 0; i < {}; i += 4)\n    dalembert::store<4, Scalar>(kept.rate[0] + i, dalembert::gather<4>(v + {}, "
          "slot_joint + i));\n",
          code_.plan.slots, base_v);
    else if (kept_role(code_, "rate"))
      text +=
          fmt::format("  for (int k = 0; k < {}; ++k) kept.rate[0][joint_slot[k]] = v[{} + k];\n", code_.tree.joints(), base_v);
    text += root();
    if (text.find("q[") == std::string::npos && text.find("(q +") == std::string::npos) text += "  (void)q;\n";
    if (text.find("v[") == std::string::npos && text.find("(v +") == std::string::npos) text += "  (void)v;\n";
    return text;
  }
  bool needs_angles() const {
    return sliding_ > 0 && turning_ > 0 &&
           (kept_role(code_, "sine") || kept_role(code_, "cosine") || kept_role(code_, "pose_sine"));
  }

 private:
  // Spreads the positions of some joints to their slots, but for the joints that carry the frame of reference if `reference`.
  std::string spread(const std::string& role, const std::string& which, const char* from, int base, bool reference) const {
    const int count = which == "sliding" ? sliding_ : turning_;
    const bool mixed = sliding_ > 0;
    const std::string joint = mixed ? which + "_joint[k]" : "k", slot = mixed ? which + "_slot[k]" : "joint_slot[k]";
    std::string skip;
    if (reference && !held_.empty()) skip = fmt::format("if (!({})) ", held_condition(joint));
    return fmt::format("  for (int k = 0; k < {}; ++k) {}kept.{}[0][{}] = {}[{} + {}];\n", count, skip, role, slot, from, base,
                       joint);
  }
  std::string held_condition(const std::string& joint) const {
    std::vector<std::string> tests;
    for (int k : held_) tests.push_back(fmt::format("{} == {}", joint, k));
    return fmt::format("{}", fmt::join(tests, " || "));
  }
  std::string sines(const std::string& prefix, int base, bool reference) const {
    if (turning_ == 0) return "";
    if (sliding_ == 0) return sines_by_segment(prefix, base);
    return "  // Sines and cosines of all angles together; slots without a turning joint stay at zero.\n" +
           spread("angle", "turning", "q", base, reference) +
           fmt::format("  dalembert::sincos<{0}>(kept.angle[0], kept.{1}sine[0], kept.{1}cosine[0]);\n", code_.plan.slots,
                       prefix);
  }
  std::string sines_by_segment(const std::string& prefix, int base) const {
    std::string text = "  // Sines and cosines of all angles together.\n";
    for (const ir::Segment& s : code_.plan.segments)
      text += fmt::format(
          "  dalembert::sincos_at<{0}>(q + {1}, slot_joint + {2}, kept.{3}sine[0] + {2}, kept.{3}cosine[0] + {2});\n",
          (s.slots() + 3) / 4 * 4, base, s.first_slot, prefix);
    return text;
  }
  std::string copy_of_sines() const {
    std::string text = fmt::format(
        "  // The joints that carry the frame of reference stand at zero in Phase I: M and C do not depend on them.\n"
        "  for (int i = 0; i < {}; ++i) {{\n    kept.pose_sine[0][i] = kept.sine[0][i];\n    kept.pose_cosine[0][i] = "
        "kept.cosine[0][i];\n  }}\n",
        code_.plan.slots);
    return text + held_at_zero();
  }
  std::string held_at_zero() const {
    std::string text;
    for (int k : held_)
      text += fmt::format("  kept.pose_sine[0][{0}] = 0;\n  kept.pose_cosine[0][{0}] = 1;\n", slot_of(code_, k));
    return text;
  }
  // The base's values, in the root's slot.
  std::string root() const {
    const auto& root = code_.rolled.root;
    std::vector<Sink> sinks;
    for (const ir::StateStore& s : root.stores)
      sinks.push_back({s.node, fmt::format("{}[{}] = ", kept(code_, s.role, s.component), slot_of(code_, -1)), ";"});
    PrintStyle style;
    style.type = "Scalar";
    style.scalar = code_.scene.scalar;
    style.input = [this](const ir::Input& in) { return input_text(code_, in); };
    return "  // The root.\n" + print(root.graph, sinks, style);
  }

  const CodeInput& code_;
  int sliding_ = 0, turning_ = 0;
  std::vector<int> held_;
};

std::string paragraphs(const CodeInput& code, size_t segment, const std::vector<std::string>& names) {
  std::string text;
  for (const ir::Paragraph& p : code.rolled.segments[segment].paragraphs)
    if (std::find(names.begin(), names.end(), p.name) != names.end()) text += paragraph_text(code, segment, p);
  return text;
}

std::string base_stage(const CodeInput& code) {
  std::vector<Sink> sinks;
  for (const ir::BlockElement& e : code.rolled.base_elements) {
    const ir::OutputArray& a = code.program.arrays[static_cast<size_t>(e.array)];
    sinks.push_back({e.node, fmt::format("workspace.{}[{}] = ", a.name, element_index(a, e.row, e.column)), ";"});
  }
  PrintStyle style;
  style.type = "Scalar";
  style.scalar = code.scene.scalar;
  style.input = [&](const ir::Input& in) {
    if (in.kind == ir::InputKind::state) return fmt::format("{}[{}]", kept(code, in.index, in.component), slot_of(code, -1));
    if (in.kind == ir::InputKind::velocity) return fmt::format("{}[{}]", kept(code, "velocity", in.index), slot_of(code, -1));
    return input_text(code, in);
  };
  return "  // Phase III: M_BB = A*, C_BB = A* ad(V) + B*; the base's gravity and bias.\n" +
         print(code.rolled.base_graph, sinks, style);
}

std::string results_stage(const CodeInput& code) {
  const int base = code.tree.floating_base ? 6 : 0, joints = code.tree.joints();
  std::string text;
  const auto copy = [&](const char* result, const char* role) {
    text += fmt::format("  for (int k = 0; k < {}; ++k) workspace.{}[{} + k] = kept.{}[0][joint_slot[k]];\n", joints, result,
                        base, role);
  };
  if (code.rolled.gravity) copy("gravity", "gravity_torque");
  if (code.rolled.bias) copy("bias", "bias_torque");
  for (int k = 0; k < joints; ++k) {
    const ir::Body& b = code.tree.bodies[static_cast<size_t>(k)];
    const int row = base + k;
    const auto value = [&](double x) { return literal(x, code.scene.scalar); };
    if (code.rolled.mass && b.armature != 0)
      text += fmt::format("  workspace.mass_matrix[{}] += {};  // armature\n", row * (code.tree.nv() + 1), value(b.armature));
    if (code.rolled.bias && b.damping != 0 && !code.scene.rates_zero)
      text += fmt::format("  workspace.bias[{0}] += {1} * v[{0}];  // damping\n", row, value(b.damping));
    if (code.rolled.bias && b.friction != 0 && !code.scene.rates_zero)
      text +=
          fmt::format("  workspace.bias[{0}] += {1} * ((v[{0}] > 0 ? 1 : 0) - (v[{0}] < 0 ? 1 : 0));  // Coulomb friction\n",
                      row, value(b.friction));
  }
  if (code.rolled.wrench) text += wrench_stage(code);
  return text;
}

// Jacobians of single links: straight, since only the joints between the link and the base matter.
ir::Program jacobians_only(const CodeInput& code) {
  ir::Program part{code.program.graph, code.program.base_positions, code.program.arrays, {}, code.program.names};
  for (const ir::OutputElement& e : code.program.elements)
    if (part.arrays[static_cast<size_t>(e.array)].name.starts_with("jacobian_")) part.elements.push_back(e);
  return part;
}

struct StageText {
  Stage stage;
  std::string body;
};

std::vector<StageText> stages(const CodeInput& code) {
  std::vector<StageText> all;
  const std::string ws = "Workspace& workspace", state = "const Scalar* q, const Scalar* v, Workspace& workspace";
  const auto add = [&](const std::string& name, const std::string& arguments, const std::string& call,
                       const std::string& body) {
    if (!body.empty()) all.push_back({{name, arguments, call}, body});
  };
  const auto& segments = code.plan.segments;
  add("prepare", state, "q, v, workspace", Prepare(code).body());
  for (size_t s = 0; s < segments.size(); ++s)
    add("outwards_" + segments[s].name, ws, "workspace",
        paragraphs(code, s, {"kinematics", "moments", "gravity_outwards", "bias_outwards"}));
  for (size_t s = segments.size(); s-- > 0;)
    add("inwards_" + segments[s].name, ws, "workspace",
        paragraphs(code, s, {"accumulate", "forces", "gravity_inwards", "bias_inwards"}));
  if (!code.rolled.base_elements.empty()) add("base", ws, "workspace", base_stage(code));
  if (code.rolled.mass || code.rolled.coriolis)
    for (size_t s = 0; s < segments.size(); ++s)
      add("elements_" + segments[s].name, ws + (elements_split(segments[s]) ? ", int begin, int end" : ""),
          elements_split(segments[s]) ? fmt::format("workspace, 0, {}", segments[s].steps) : "workspace",
          elements_stage(code, s));
  add("results", "const Scalar* v, Workspace& workspace", "v, workspace", results_stage(code));
  const ir::Program jacobians = jacobians_only(code);
  if (!jacobians.elements.empty()) add("jacobians", state, "q, v, workspace", straight_statements(code, jacobians));
  return all;
}

}  // namespace

std::vector<KeptArray> kept_arrays(const CodeInput& code) {
  std::vector<KeptArray> arrays;
  if (Prepare(code).needs_angles()) arrays.push_back({"angle", 1, stride(code), "q of turning joints, rad"});
  for (const ir::Role& r : code.rolled.roles)
    if (!r.name.empty() && r.place < 0) arrays.push_back({r.name, r.components, stride(code), r.meaning});
  return arrays;
}

std::string rolled_workspace(const CodeInput& code) {
  std::string text = fmt::format(
      "// Room to work in: one value per slot, a slot per body of a limb and lane; the root's slot is {}.\nstruct Kept {{\n",
      code.plan.root_slot);
  for (const KeptArray& a : kept_arrays(code))
    text += fmt::format("  alignas(64) Scalar {}[{}][{}] = {{}};  // {}\n", a.name, a.components, a.slots, a.meaning);
  for (const ir::Role& r : code.rolled.roles) {
    if (r.name.empty() || r.place < 0) continue;
    text += fmt::format("  Scalar* {0}(int i) noexcept {{ return {1}[i]; }}  // {2}; where nobody reads {1} any more\n", r.name,
                        code.rolled.roles[static_cast<size_t>(r.place)].name, r.meaning);
  }
  return text + "};\n";
}

std::vector<Stage> rolled_stages(const CodeInput& code) {
  std::vector<Stage> list;
  for (const StageText& s : stages(code)) list.push_back(s.stage);
  return list;
}

std::string rolled_source(const CodeInput& code, const std::string& banner) {
  std::string tables, text, calls, includes;
  for (size_t s = 0; s < code.plan.segments.size(); ++s) {
    tables += "\n// " + code.plan.segments[s].name + ", a row per step, a column per lane\n" + segment_tables(code, s);
    tables += limb_tables(code, s);
  }
  tables += wrench_tables(code);
  for (const StageText& s : stages(code)) {
    const bool keeps = s.body.find("kept.") != std::string::npos && !s.body.starts_with(open_stage);
    std::string unused;
    if (s.body.find("workspace") == std::string::npos && !keeps) unused += "  (void)workspace;\n";
    if (s.stage.arguments.starts_with("const Scalar* v") && s.body.find("v[") == std::string::npos) unused += "  (void)v;\n";
    text += fmt::format("{}void {}({}) noexcept {{\n{}{}{}}}\n\n", code.plan.tasks ? "" : "static ", s.stage.name,
                        s.stage.arguments, keeps ? open_stage : "", unused, s.body);
    calls += fmt::format("  {}{}({});\n", code.plan.tasks ? "stages::" : "", s.stage.name, s.stage.call);
  }
  tables = joint_tables(code, text) + tables;
  for (const auto& [name, word] : {std::pair{"blocks", "dalembert::limb_blocks"},
                                   {"runs", "dalembert::run_block"},
                                   {"sincos", "dalembert::sincos"},
                                   {"wrench", "dalembert::wrench_columns"}})
    if (text.find(word) != std::string::npos) includes += fmt::format("#include <dalembert/{}.hpp>\n", name);
  if (includes.empty()) includes = "#include <dalembert/lanes.hpp>\n";
  return render("rolled.cpp", {{"banner", banner},
                               {"name", code.name},
                               {"includes", includes},
                               {"layout", layout(code)},
                               {"tables", tables},
                               {"stages_open", code.plan.tasks ? "namespace stages {\n\n" : ""},
                               {"stages", text},
                               {"stages_close", code.plan.tasks ? "}  // namespace stages\n\n" : ""},
                               {"calls", calls}});
}

}  // namespace dalembert::backend
