#include "backend/emit_embedded.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "backend/code_text.hpp"
#include "backend/graph_printer.hpp"
#include "backend/kept.hpp"
#include "backend/kernel_text.hpp"
#include "backend/literals.hpp"
#include "ir/identifier.hpp"

namespace dalembert::backend {
namespace {

// How printed expressions of a linkage's rows read what they take.
PrintStyle style_of(const CodeInput& code, const std::vector<int>& angles) {
  PrintStyle style;
  style.type = "Scalar";
  style.scalar = code.scene.scalar;
  style.indent = "    ";
  style.input = [](const ir::Input& input) {
    return fmt::format("{}[{}]", input.kind == ir::InputKind::position ? "q" : "rate", input.index);
  };
  style.sine_or_cosine = [angles](const ir::Graph& graph, ir::NodeId id) {
    const auto at = std::find(angles.begin(), angles.end(), graph[graph[id].a].input.index);
    return fmt::format("{}[{}]", graph[id].op == ir::Op::sine ? "sine" : "cosine", at - angles.begin());
  };
  return style;
}

// Where in q the angles are whose sines some nodes need.
std::vector<int> angles_of(const ir::Graph& graph, const std::vector<ir::NodeId>& roots) {
  std::vector<int> angles;
  const auto used = ir::uses(graph, roots);
  for (ir::NodeId id = 0; id < graph.size(); ++id) {
    if (used[static_cast<size_t>(id)] == 0 || (graph[id].op != ir::Op::sine && graph[id].op != ir::Op::cosine)) continue;
    const int at = graph[graph[id].a].input.index;
    if (std::find(angles.begin(), angles.end(), at) == angles.end()) angles.push_back(at);
  }
  return angles;
}

std::string statements(const ir::LinkageRows& rows, const std::vector<std::vector<ir::NodeId>>& matrix, const std::string& to,
                       bool errors, const PrintStyle& style) {
  std::vector<Sink> sinks;
  for (size_t r = 0; errors && r < rows.error.size(); ++r)
    sinks.push_back({rows.error[r], fmt::format("error[{}] = ", r), ";"});
  for (size_t r = 0; r < matrix.size(); ++r)
    for (size_t c = 0; c < matrix[r].size(); ++c) sinks.push_back({matrix[r][c], fmt::format("{}[{}][{}] = ", to, r, c), ";"});
  return print(rows.graph, sinks, style);
}

std::string linkage_struct(const CodeInput& code, size_t i) {
  const ir::Linkage& linkage = code.tree.linkages[i];
  const ir::LinkageRows rows = ir::linkage_rows(linkage, code.tree);
  const ir::LinkagePlaces places = ir::linkage_places(linkage, code.tree);
  std::vector<ir::NodeId> all = rows.at_rest();
  const std::vector<ir::NodeId> moving = rows.moving();
  all.insert(all.end(), moving.begin(), moving.end());
  std::vector<int> angles = angles_of(rows.graph, all);
  const PrintStyle style = style_of(code, angles);
  const size_t count = angles.size();
  while (angles.size() % 8 != 0) angles.push_back(angles.back());
  const std::string room =
      fmt::format("  alignas(64) Scalar sine[dalembert::padded({0})], cosine[dalembert::padded({0})];\n", count);
  const std::string sines =
      fmt::format("    static constexpr int angle_at[] = {{{}}};\n    dalembert::sincos_at<{}>(q, angle_at, sine, cosine);\n",
                  fmt::join(angles, ", "), count);
  std::vector<std::string> names;
  for (const ir::LinkageLoop& loop : linkage.loops) names.push_back(loop.name);
  return comment_lines(fmt::format("Rows of linkage {}, of {}: dependent joints' columns first.", i, fmt::join(names, ", "))) +
         fmt::format(
             "struct Linkage{0} {{\n"
             "  static constexpr int dependent = {1}, independent = {2}, most_dependent = {1}, most_columns = {3};\n"
             "  static constexpr int positions[] = {{{4}}}, followed[] = {{{5}}};\n{6}\n"
             "  void at([[maybe_unused]] const Scalar* q, Scalar (&error)[{1}], Scalar (&J)[{1}][{3}]) noexcept {{\n{7}{8}  "
             "}}\n"
             "  void rates([[maybe_unused]] const Scalar* q, [[maybe_unused]] const Scalar* rate, Scalar (&J_rate)[{1}][{3}]) "
             "const noexcept {{\n{9}  }}\n}};\n\n",
             i, linkage.dependent.size(), linkage.independent.size(), linkage.dependent.size() + linkage.independent.size(),
             fmt::join(places.positions, ", "), fmt::join(places.followed, ", "), count > 0 ? room : "", count > 0 ? sines : "",
             statements(rows, rows.jacobian, "J", true, style), statements(rows, rows.rate, "J_rate", false, style));
}

}  // namespace

std::string linkage_structs(const CodeInput& code) {
  if (code.tree.linkages.empty()) return "";
  std::string text = "\nnamespace {\n\n";
  for (size_t i = 0; i < code.tree.linkages.size(); ++i) text += linkage_struct(code, i);
  const ir::Followers f = ir::followers(code.tree);
  std::vector<std::string> elements, runs;
  for (const Follower& element : f.elements) elements.push_back(fmt::format("{{{}, {}}}", element.coordinate, element.follows));
  for (size_t i = 0, end = 1; i < f.at.size(); i = end++) {
    while (end < f.at.size() && f.at[end] == f.at[end - 1] + 1) ++end;
    runs.push_back(fmt::format("{}, {}, {}", i, f.at[i], end - i));
  }
  text += fmt::format(
      "// Which of all coordinates those of v are: of v, of all, how many, … Dependent ones, and what they follow.\n"
      "using independent_runs = dalembert::IndependentRuns<\n    {}>;\nconstexpr dalembert::Follower followers[] = {{\n    "
      "{}}};\n\n}}  // namespace\n\n",
      wrapped(runs, 4), wrapped(elements, 4));
  text += fmt::format(
      "// Where every joint has its coordinate.\nnamespace of_all_joints {{\n\n[[maybe_unused]] constexpr int nv = {};\n\n}}  "
      "// "
      "namespace of_all_joints\n\n",
      f.all);
  text += "dalembert::LinkageStatus<Scalar> close_loops(Scalar* q) noexcept {\n  dalembert::LinkageStatus<Scalar> status;\n";
  for (size_t i = 0; i < code.tree.linkages.size(); ++i)
    text += fmt::format("  {{\n    Linkage{0} rows;\n    dalembert::close_linkage(rows, {0}, {1}, q, status);\n  }}\n", i,
                        ir::closing_steps);
  return text + "  return status;\n}\n\n";
}

std::string closing_declaration(const CodeInput& code) {
  if (code.tree.linkages.empty()) return "";
  return fmt::format(
      "// Closes the embedded loops: q's dependent joints move by {} steps of Newton's from where they are, independent ones "
      "stay.\n"
      "// Says what is left, m or rad, and the least pivot: at a toggle point joints stay where they are.\n"
      "dalembert::LinkageStatus<Scalar> close_loops(Scalar* q) noexcept;\n"
      "inline dalembert::LinkageStatus<Scalar> close_loops(VectorQ& q) noexcept {{ return close_loops(q.data()); }}\n\n",
      ir::closing_steps);
}

std::string embedded_statements(const CodeInput& code) {
  const ir::Embedding& e = *code.algorithm.embedding;
  const ir::EmittedFunction& function = code.algorithm.function;
  const ir::Followers f = ir::followers(code.tree);
  const int all = f.all, count = static_cast<int>(f.elements.size());
  const auto array = [&](int index) { return "workspace." + code.algorithm.arrays[static_cast<size_t>(index)].name; };
  const auto size = [&](int index) {
    const ir::OutputArray& a = code.algorithm.arrays[static_cast<size_t>(index)];
    return a.rows * a.columns;
  };
  const bool turns = e.rates >= 0;
  const std::string status = "workspace." + own_name(code, "linkage_status"), G = array(e.elements),
                    rate = turns ? array(e.rates) : "";
  std::string text = fmt::format("  {} = {{}};\n", status);
  if (!e.moving) text += "  (void)v;\n";
  if (*function.input() && !e.of_input && std::none_of(e.projected.begin(), e.projected.end(), [](const ir::Projected& p) {
        return p.kind == ir::Projected::Kind::unbalanced;
      }))
    text += fmt::format("  (void){};\n", function.input());
  text += turns ? "  // Dependent joints follow: v_d = G y', v_d' = G y'' + G' y'.\n"
                : "  // Dependent joints follow: v_d = G y'.\n";
  int first = 0;
  for (size_t i = 0; i < code.tree.linkages.size(); ++i) {
    const ir::Linkage& linkage = code.tree.linkages[i];
    text += fmt::format("  {{\n    Linkage{0} rows;\n    dalembert::follow<Linkage{0}, Scalar>(rows, {0}, q, ", i) +
            (turns ? fmt::format("v, {0} + {2}, {1} + {2}, {3});\n  }}\n", G, rate, first, status)
                   : fmt::format("nullptr, {0} + {1}, nullptr, {2});\n  }}\n", G, first, status));
    first += static_cast<int>(linkage.dependent.size() * linkage.independent.size());
  }
  const auto spread = [&](const std::string& from, int to) {
    return fmt::format("  dalembert::spread<independent_runs, {}, {}>(followers, {}, {}, {});\n", all, count, G, from,
                       array(to));
  };
  if (e.moving) text += spread("v", e.speeds);
  if (e.accelerated) {
    if (e.of_input) text += spread(function.input(), e.accelerations);
    else text += fmt::format("  for (Scalar& x : {}) x = 0;\n", array(e.accelerations));
    if (turns)
      text += fmt::format("  dalembert::add_turning<{}>(followers, {}, v, {});\n", count, rate, array(e.accelerations));
  }
  text += fmt::format("  of_all_joints::{}(q, {}{}, workspace);\n", e.called, array(e.speeds),
                      e.accelerated ? ", " + array(e.accelerations) : "");
  text += "  // What the tree has, of the independent coordinates.\n";
  using Kind = ir::Projected::Kind;
  const auto columns = [&](const ir::Projected& p, const std::string& from, const std::string& to) {
    return fmt::format("  dalembert::project_columns<independent_runs, {}, {}>(followers, {}, {}, {});\n", p.from_rows, count,
                       G, from, to);
  };
  const auto rows = [&](int of_columns, const std::string& from, const std::string& to) {
    return fmt::format("  dalembert::project_rows<independent_runs, {}, nv, {}, {}>(followers, {}, {}, {});\n", of_columns, all,
                       count, G, from, to);
  };
  const auto both = [&](const std::string& from, const std::string& turned, const std::string& by, const std::string& to) {
    return fmt::format("  dalembert::project_both<independent_runs, nv, {}, {}, Scalar>(followers, {}, {}, {}, {}, {});\n", all,
                       count, G, from, turned, by, to);
  };
  for (const ir::Projected& p : e.projected) {
    const std::string from = "workspace." + p.from, more = "workspace." + p.more, to = array(p.to);
    const auto add_bias = [&](const std::string& target) {
      return turns ? fmt::format("  dalembert::add_bias<{}, {}>(followers, {}, v, {}, {}, {});\n", p.from_rows, count, rate,
                                 more, from, target)
                   : fmt::format("  dalembert::copy_numbers<{}>({}, {});\n", p.from_rows, from, target);
    };
    switch (p.kind) {
      case Kind::same:
        text += fmt::format("  dalembert::copy_numbers<{}>({}, {});\n", p.from_rows * p.from_columns, from, to);
        break;
      case Kind::columns: text += columns(p, from, to); break;
      case Kind::rows: text += rows(p.from_columns, from, to); break;
      case Kind::both: text += both(from, "nullptr", "nullptr", to); break;
      case Kind::both_turned: text += both(from, more, rate, to); break;
      case Kind::turned: text += add_bias(to); break;
      case Kind::rows_of_turned: text += add_bias(array(p.room)) + rows(1, array(p.room), to); break;
      case Kind::unbalanced:
        text += rows(1, from, to) + fmt::format("  dalembert::subtract_from<nv>({}, {});\n", function.input(), to);
        break;
    }
  }
  text += kernel_statements(code) + guard_statements(code);
  for (size_t a = 0; a < code.algorithm.arrays.size(); ++a)
    if (!code.algorithm.arrays[a].internal)
      text += fmt::format("  dalembert::clear_at_toggle_point<{}>({}, {});\n", size(static_cast<int>(a)), status,
                          array(static_cast<int>(a)));
  return text;
}

std::string opened_scope(const CodeInput& code, const std::string& text) {
  return fmt::format("\nnamespace of_all_joints {{\n\n{}\n{}\n}}  // namespace of_all_joints\n", section_declaration(code),
                     text);
}

std::string dependent_joints(const CodeInput& code) {
  const std::vector<int> positions = code.tree.positions();
  std::string text = "// Dependent joints, which follow the others by loops, have positions only:\n";
  for (const ir::Linkage& linkage : code.tree.linkages)
    for (const int k : linkage.dependent)
      text += comment_lines(fmt::format("  {:<32} q[{}]", code.tree.bodies[static_cast<size_t>(k)].joint,
                                        code.tree.base_positions() + positions[static_cast<size_t>(k)]),
                            0, 4);
  return text;
}

}  // namespace dalembert::backend
