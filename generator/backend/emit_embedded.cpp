#include "backend/emit_embedded.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "backend/code_text.hpp"
#include "backend/kept.hpp"
#include "backend/literals.hpp"
#include "ir/identifier.hpp"

namespace dalembert::backend {
namespace {

template <size_t count>
std::string numbers(const CodeInput& code, const double (&values)[count]) {
  std::vector<std::string> all;
  for (const double x : values) all.push_back(literal(x, code.scene.scalar));
  return fmt::format("{{{}}}", fmt::join(all, ", "));
}

// Template arguments of a linkage: how many depend, and on how many.
std::string sizes(const ir::Linkage& linkage) {
  return fmt::format("{}, {}", linkage.dependent.size(), linkage.independent.size());
}

}  // namespace

std::string linkage_tables(const CodeInput& code) {
  if (code.tree.linkages.empty()) return "";
  std::string text = "\nnamespace {\n\n";
  const auto number = [&](double x) { return literal(x, code.scene.scalar); };
  for (size_t i = 0; i < code.tree.linkages.size(); ++i) {
    const ir::Linkage& linkage = code.tree.linkages[i];
    const ir::LinkageTable table = ir::linkage_table(linkage, code.tree);
    std::vector<std::string> joints, loops;
    for (const LinkedJoint<double>& joint : table.joints)
      joints.push_back(fmt::format("{{{}, {}, {}, {},\n     {},\n     {}, {}}}", joint.position, joint.column,
                                   number(joint.turns), number(joint.slides), numbers(code, joint.rotation),
                                   numbers(code, joint.translation), numbers(code, joint.axis)));
    std::vector<std::string> names;
    for (size_t l = 0; l < table.loops.size(); ++l) {
      const LinkedLoop<double>& loop = table.loops[l];
      names.push_back(linkage.loops[l].name);
      loops.push_back(fmt::format("{{{{{}, {}, {}}},\n     {{{},\n      {}}},\n     {{{}, {}}}, {}, {}, {}}}", loop.begin[0],
                                  loop.begin[1], loop.begin[2], numbers(code, loop.rotation[0]),
                                  numbers(code, loop.rotation[1]), numbers(code, loop.translation[0]),
                                  numbers(code, loop.translation[1]), loop.linear, loop.angular, number(loop.length)));
    }
    text += comment_lines(fmt::format("Linkage {}, of {}: joints from where a loop's links hang to each of them.", i,
                                      fmt::join(names, ", "))) +
            fmt::format(
                "constexpr dalembert::LinkedJoint<Scalar> linkage_{0}_joints[] = {{\n    {1}}};\n"
                "constexpr dalembert::LinkedLoop<Scalar> linkage_{0}_loops[] = {{\n    {2}}};\n"
                "constexpr int linkage_{0}_positions[] = {{{3}}}, linkage_{0}_coordinates[] = {{{4}}}, linkage_{0}_followed[] "
                "= {{{5}}};\n"
                "constexpr dalembert::Linkage<Scalar> linkage_{0}{{linkage_{0}_loops, {6}, linkage_{0}_joints, {7},\n"
                "    linkage_{0}_positions, linkage_{0}_coordinates, linkage_{0}_followed}};\n\n",
                i, fmt::join(joints, ",\n    "), fmt::join(loops, ",\n    "), fmt::join(table.dependent_positions, ", "),
                fmt::join(table.dependent_coordinates, ", "), fmt::join(table.independent_coordinates, ", "), loops.size(),
                sizes(linkage));
  }
  const ir::Followers f = ir::followers(code.tree);
  std::vector<std::string> elements, at;
  for (const Follower& element : f.elements) elements.push_back(fmt::format("{{{}, {}}}", element.coordinate, element.follows));
  for (const int i : f.at) at.push_back(std::to_string(i));
  text += fmt::format(
      "// Which of all coordinates those of v are; dependent ones, and what they follow.\n"
      "constexpr int independent_at[] = {{\n    {}}};\nconstexpr dalembert::Follower followers[] = {{\n    {}}};\n\n}}  // "
      "namespace\n\n",
      wrapped(at, 4), wrapped(elements, 4));
  text += fmt::format(
      "// Where every joint has its coordinate.\nnamespace of_all_joints {{\n\n[[maybe_unused]] constexpr int nv = {};\n\n}}  "
      "// "
      "namespace of_all_joints\n\n",
      f.all);
  text += "dalembert::LinkageStatus<Scalar> close_loops(Scalar* q) noexcept {\n  dalembert::LinkageStatus<Scalar> status;\n";
  for (size_t i = 0; i < code.tree.linkages.size(); ++i)
    text += fmt::format("  dalembert::close_linkage<{1}>(linkage_{0}, {0}, {2}, q, status);\n", i, sizes(code.tree.linkages[i]),
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
  const int nv = code.tree.nv(), all = f.all, count = static_cast<int>(f.elements.size());
  const auto array = [&](int index) { return "workspace." + code.algorithm.arrays[static_cast<size_t>(index)].name; };
  const auto size = [&](int index) {
    const ir::OutputArray& a = code.algorithm.arrays[static_cast<size_t>(index)];
    return a.rows * a.columns;
  };
  const bool moves = e.rates >= 0;
  const std::string status = "workspace." + own_name(code, "linkage_status"), G = array(e.elements),
                    rate = moves ? array(e.rates) : "";
  std::string text = fmt::format("  {} = {{}};\n", status);
  if (!moves) text += "  (void)v;\n";
  if (*function.input() && !e.of_input && std::none_of(e.projected.begin(), e.projected.end(), [](const ir::Projected& p) {
        return p.kind == ir::Projected::Kind::unbalanced;
      }))
    text += fmt::format("  (void){};\n", function.input());
  text += "  // Dependent joints follow: v_d = G y', v_d' = G y'' + G' y'.\n";
  int first = 0;
  for (size_t i = 0; i < code.tree.linkages.size(); ++i) {
    const ir::Linkage& linkage = code.tree.linkages[i];
    text += moves ? fmt::format("  dalembert::follow<{1}>(linkage_{0}, {0}, q, v, {2} + {4}, {3} + {4}, {5});\n", i,
                                sizes(linkage), G, rate, first, status)
                  : fmt::format("  dalembert::follow<{1}, Scalar>(linkage_{0}, {0}, q, nullptr, {2} + {3}, nullptr, {4});\n", i,
                                sizes(linkage), G, first, status);
    first += static_cast<int>(linkage.dependent.size() * linkage.independent.size());
  }
  const auto spread = [&](const std::string& from, int to) {
    return fmt::format("  dalembert::spread<nv, {}, {}>(independent_at, followers, {}, {}, {});\n", all, count, G, from,
                       array(to));
  };
  if (moves) text += spread("v", e.speeds);
  if (e.accelerated) {
    if (e.of_input) text += spread(function.input(), e.accelerations);
    else text += fmt::format("  for (Scalar& x : {}) x = 0;\n", array(e.accelerations));
    if (moves)
      text += fmt::format("  dalembert::add_turning<{}>(followers, {}, v, {});\n", count, rate, array(e.accelerations));
  }
  text += fmt::format("  of_all_joints::{}(q, {}{}, workspace);\n", e.called, array(e.speeds),
                      e.accelerated ? ", " + array(e.accelerations) : "");
  text += "  // What the tree has, of the independent coordinates.\n";
  using Kind = ir::Projected::Kind;
  const auto columns = [&](const ir::Projected& p, const std::string& from, const std::string& to) {
    return fmt::format("  dalembert::project_columns<{}, nv, {}>(independent_at, followers, {}, {}, {});\n", p.from_rows, count,
                       G, from, to);
  };
  const auto rows = [&](int of_columns, const std::string& from, const std::string& to) {
    return fmt::format("  dalembert::project_rows<{}, nv, {}, {}>(independent_at, followers, {}, {}, {});\n", of_columns, all,
                       count, G, from, to);
  };
  for (const ir::Projected& p : e.projected) {
    const std::string from = "workspace." + p.from, more = "workspace." + p.more, to = array(p.to);
    const auto add_bias = [&](const std::string& target) {
      return moves ? fmt::format("  dalembert::add_bias<{}, {}>(followers, {}, v, {}, {}, {});\n", p.from_rows, count, rate,
                                 more, from, target)
                   : fmt::format("  dalembert::copy_numbers<{}>({}, {});\n", p.from_rows, from, target);
    };
    switch (p.kind) {
      case Kind::same:
        text += fmt::format("  dalembert::copy_numbers<{}>({}, {});\n", p.from_rows * p.from_columns, from, to);
        break;
      case Kind::columns: text += columns(p, from, to); break;
      case Kind::rows: text += rows(p.from_columns, from, to); break;
      case Kind::both: text += columns(p, from, array(p.room)) + rows(nv, array(p.room), to); break;
      case Kind::coriolis:
        text += columns(p, from, array(p.room)) +
                fmt::format("  dalembert::add_turning_columns<{}, {}>(followers, {}, {}, {});\n", all, count, rate, more,
                            array(p.room)) +
                rows(nv, array(p.room), to);
        break;
      case Kind::bias: text += add_bias(to); break;
      case Kind::force: text += add_bias(array(p.room)) + rows(1, array(p.room), to); break;
      case Kind::unbalanced:
        text += rows(1, from, to) + fmt::format("  dalembert::subtract_from<nv>({}, {});\n", function.input(), to);
        break;
    }
  }
  text += matrix_statements(code) + guard_statements(code);
  for (size_t a = 0; a < code.algorithm.arrays.size(); ++a)
    if (!code.algorithm.arrays[a].internal)
      text += fmt::format("  dalembert::clear_at_toggle_point<{}>({}, {});\n", size(static_cast<int>(a)), status,
                          array(static_cast<int>(a)));
  return text;
}

std::string opened_scope(const CodeInput& code, const std::string& text) {
  return fmt::format("\nnamespace of_all_joints {{\n\n{}\n{}\n}}  // namespace of_all_joints\n", second_half_declaration(code),
                     text);
}

std::string embedded_joint_indices(const CodeInput& code) {
  const std::vector<int> positions = code.tree.positions();
  std::string text =
      "// Joints with a coordinate in v, in its order: a joint's position is q[q_index(joint)], its rate v[v_index(joint)].\n"
      "// Dependent joints, which follow them by loops, have positions only:\n";
  for (const ir::Linkage& linkage : code.tree.linkages)
    for (const int k : linkage.dependent)
      text += comment_lines(fmt::format("  {:<32} q[{}]", code.tree.bodies[static_cast<size_t>(k)].joint,
                                        code.tree.base_positions() + positions[static_cast<size_t>(k)]),
                            0, 4);
  return text;
}

}  // namespace dalembert::backend
