#include "backend/code_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "backend/literals.hpp"
#include "ir/constraint_step.hpp"
#include "ir/coordinate_tree.hpp"
#include "ir/identifier.hpp"

namespace dalembert::backend {

std::string input_text(const CodeInput& code, const ir::Input& input) {
  switch (input.kind) {
    case ir::InputKind::position: return fmt::format("q[{}]", input.index);
    case ir::InputKind::velocity: return fmt::format("v[{}]", input.index);
    case ir::InputKind::acceleration:
    case ir::InputKind::effort: return fmt::format("{}[{}]", code.algorithm.section.input(), input.index);
    case ir::InputKind::gravity: return fmt::format("workspace.gravity_vector[{}]", input.component);
    case ir::InputKind::wrench:
      return fmt::format("workspace.wrench_{}[{}]",
                         ir::identifier(code.scene.wrenches.at(static_cast<size_t>(input.index)).link), input.component);
    case ir::InputKind::constraint: {
      const std::string contact = "workspace." + code.scene.constraints().at(static_cast<size_t>(input.index)).member;
      if (input.component == ir::contact_kp) return contact + ".kp";
      if (input.component == ir::contact_kd) return contact + ".kd";
      if (input.component == ir::contact_restitution) return contact + ".restitution";
      return fmt::format("{}.anchor[{}]", contact, input.component - ir::contact_anchor);
    }
    case ir::InputKind::element:
      return fmt::format("workspace.{}[{}]", code.algorithm.arrays[static_cast<size_t>(input.index)].name, input.component);
    case ir::InputKind::payload: {
      const std::string payload =
          "workspace.payload_" + ir::identifier(code.scene.payloads.at(static_cast<size_t>(input.index)));
      if (input.component == 0) return payload + ".mass";
      if (input.component < 4) return fmt::format("{}.com[{}]", payload, input.component - 1);
      return fmt::format("{}.inertia[{}]", payload, input.component - 4);
    }
    default: throw std::logic_error("an input of a loop outside a loop");
  }
}

const ir::EmittedFunction& function_of(const CodeInput& code) { return code.algorithm.function; }

std::string own_name(const CodeInput& code, const std::string& name) { return code.algorithm.own_name(name); }

std::string own_type(const CodeInput& code, const std::string& type) { return code.algorithm.section.type + type; }

std::vector<std::string> vectors_of(const CodeInput& code) {
  std::vector<std::string> names{"q", "v"};
  if (const char* input = code.algorithm.section.input(); *input) names.emplace_back(input);
  return names;
}

std::string parameters_of(const CodeInput& code, const std::string& pointer) {
  return pointer + fmt::format("{}", fmt::join(vectors_of(code), ", " + pointer));
}

std::string arguments_of(const CodeInput& code) { return fmt::format("{}", fmt::join(vectors_of(code), ", ")); }

EigenVectors eigen_vectors_of(const CodeInput& code) {
  std::vector<std::string> templates, types, vectors, parameters;
  for (const std::string& name : vectors_of(code)) {
    types.push_back(name);
    types.back().front() = static_cast<char>(std::toupper(static_cast<unsigned char>(name.front())));
    vectors.emplace_back(name == "q" ? "VectorQ" : "VectorV");
    templates.push_back(fmt::format("class {} = {}", types.back(), vectors.back()));
    parameters.push_back(fmt::format("const {}& {}", types.back(), name));
  }
  const auto list = [](const std::vector<std::string>& items) { return fmt::format("{}", fmt::join(items, ", ")); };
  return {list(templates), list(types), list(vectors), list(parameters)};
}

namespace {

std::string chains_text(const ir::CoordinateTree& tree) {
  std::vector<int> begin, above, depth;
  for (const ir::Chain& chain : ir::chains(tree)) {
    const int directly_above = tree.above[static_cast<size_t>(chain.first)];
    const auto of = std::upper_bound(begin.begin(), begin.end(), directly_above) - begin.begin() - 1;
    above.push_back(static_cast<int>(of));  // coordinates before the first chain: none
    begin.push_back(chain.first);
    depth.push_back(tree.depth(chain.first));
  }
  begin.push_back(tree.size());
  return fmt::format(
      "  static constexpr int chain_begin[] = {{{}}}, chain_above[] = {{{}}}, chain_depth[] = {{{}}};\n"
      "  static constexpr dalembert::Chains chains{{{}, chain_begin, chain_above, chain_depth}};\n",
      fmt::join(begin, ", "), fmt::join(above, ", "), fmt::join(depth, ", "), above.size());
}

std::string above_text(const ir::CoordinateTree& tree) {
  return fmt::format("  static constexpr int coordinate_above[] = {{{}}};\n", fmt::join(tree.above, ", "));
}

// What stands above each chain that M's inverse and products with it go by, and its name, by the chain's first coordinate.
std::map<int, std::string> coordinates_above(const CodeInput& code, std::string& text) {
  const ir::CoordinateTree tree = ir::coordinate_tree(code.tree);
  std::map<int, std::string> names;
  std::map<int, std::string> by_parent;  // chains that hang on one coordinate share a table
  for (const ir::MatrixStep& s : code.algorithm.steps_of<ir::MatrixStep>()) {
    if (s.kind != ir::MatrixStep::Kind::invert && s.kind != ir::MatrixStep::Kind::negative_product) continue;
    for (const ir::Chain& chain : ir::chains(tree, s.first)) {
      const int parent = tree.above[static_cast<size_t>(chain.first)];
      const auto [at, is_new] = by_parent.try_emplace(parent, "{nullptr, 0}");
      if (is_new && parent >= 0) {
        std::vector<int> path;
        for (int k = parent; k >= 0; k = tree.above[static_cast<size_t>(k)]) path.push_back(k);
        text += fmt::format("  static constexpr int coordinate_{}_and_above[] = {{{}}};\n", parent, fmt::join(path, ", "));
        at->second = fmt::format("{{coordinate_{}_and_above, {}}}", parent, path.size());
      }
      names[chain.first] = at->second;
    }
  }
  return names;
}

}  // namespace

std::string matrix_statements(const CodeInput& code) {
  const std::vector<ir::MatrixStep> steps = code.algorithm.steps_of<ir::MatrixStep>();
  if (steps.empty()) return "";
  const auto name = [&](int index) { return "workspace." + code.algorithm.arrays[static_cast<size_t>(index)].name; };
  const ir::CoordinateTree tree = ir::coordinate_tree(code.tree);
  using Kind = ir::MatrixStep::Kind;
  std::string text;
  const std::map<int, std::string> above = coordinates_above(code, text);
  if (solves(code)) text += chains_text(tree);
  for (const ir::MatrixStep& s : steps) {
    switch (s.kind) {
      case Kind::factor:
        text += fmt::format("  dalembert::factorise<nv, {}, chains>({}, {}, {}, {}, {});\n", ir::most_above(tree) + 1,
                            name(s.a), name(s.room), name(s.to), name(s.b), name(code.algorithm.guard->diagonal));
        break;
      case Kind::solve: text += fmt::format("  dalembert::solve_one<nv, chains>({}, {});\n", name(s.a), name(s.to)); break;
      case Kind::invert:
        for (const ir::Chain& chain : ir::chains(tree, s.first))
          text += fmt::format("  dalembert::invert_chain<nv, {}>({}, {}, {}, {}, {});\n", chain.count, chain.first,
                              above.at(chain.first), name(s.a), name(s.b), name(s.room));
        text += fmt::format("  dalembert::without_padding<nv>({}, {});\n", name(s.room), name(s.to));
        break;
      case Kind::negative_product:
        for (const ir::Chain& chain : ir::chains(tree, s.first))
          text += fmt::format("  dalembert::negative_product_chain<nv>({}, {}, {}, {}, {}, {}, {});\n", chain.first,
                              chain.first + chain.count, tree.last[static_cast<size_t>(chain.first)], above.at(chain.first),
                              name(s.a), name(s.b), name(s.to));
        break;
    }
  }
  return text;
}

namespace {

// dalembert::ConstraintRows of the steps' constraints.
std::string rows_type(const ir::ConstraintPaths& paths) {
  std::vector<std::string> all;
  for (size_t c = 0; c + 1 < paths.first.size(); ++c) {
    const int rows = paths.first[c + 1] - paths.first[c], length = paths.length(c);
    const bool forked = paths.common[c] < length;
    std::string type = fmt::format("RowPath<{}", rows);
    if (forked || paths.linear[c] != std::min(rows, 3))
      type = fmt::format("LoopPath<{}, {}, {}, {}", rows, paths.linear[c], paths.common[c], paths.split[c]);
    for (int i = 0; i < length; ++i) type += fmt::format(", {}", paths.path[static_cast<size_t>(paths.begin[c] + i)]);
    all.push_back("dalembert::" + type + ">");
  }
  return fmt::format("dalembert::ConstraintRows<\n      {}>", fmt::join(all, ",\n      "));
}

// dalembert::ChainTree of the robot's coordinates.
std::string tree_type(const ir::CoordinateTree& tree) {
  std::vector<std::string> all;
  for (const ir::Chain& chain : ir::chains(tree)) {
    std::string runs;
    int begin = -1, behind = -1;
    const auto add = [&] {
      if (begin >= 0) runs += fmt::format(", {}, {}", begin, behind);
    };
    for (int k = tree.above[static_cast<size_t>(chain.first)]; k >= 0; k = tree.above[static_cast<size_t>(k)]) {
      if (k != begin - 1) add(), behind = k + 1;
      begin = k;
    }
    add();
    all.push_back(fmt::format("dalembert::ChainBelow<{}, {}{}>", chain.first, chain.count, runs));
  }
  return fmt::format("dalembert::ChainTree<\n      {}>", fmt::join(all, ",\n      "));
}

}  // namespace

std::string constraint_statements(const CodeInput& code, const std::string& limbs, const std::string& axes) {
  const std::vector<ir::ConstraintStep> steps = code.algorithm.steps_of<ir::ConstraintStep>();
  if (steps.empty()) return "";
  const auto name = [&](int index) { return "workspace." + code.algorithm.arrays[static_cast<size_t>(index)].name; };
  std::string text = fmt::format("  using ConstraintsOfScene = {};\n", rows_type(steps.front().paths));
  using Kind = ir::ConstraintStep::Kind;
  const auto any = [&](const auto& of) {
    return std::any_of(steps.begin(), steps.end(), [&](const ir::ConstraintStep& s) { return of(s.kind); });
  };
  const bool solved = any([](Kind kind) { return kind == Kind::solve || kind == Kind::impact; }),
             responds = any([](Kind kind) { return kind == Kind::respond; }),
             supported = any([](Kind kind) { return kind == Kind::support; });
  if (solved || responds || supported) {
    std::vector<std::string> active, regularization, weights;
    for (const ir::Constraint& constraint : code.scene.constraints()) {
      const std::string member = "workspace." + constraint.member;
      active.push_back(fmt::format("{}.active ? Scalar(1) : Scalar(0)", member));
      for (int i = 0; i < constraint.rows; ++i) {
        regularization.push_back(fmt::format("{}.regularization[{}]", member, i));
        weights.push_back(fmt::format("{}.weight[{}]", member, i));
      }
    }
    if (solved) text += fmt::format("  using CoordinateTree = {};\n", tree_type(ir::coordinate_tree(code.tree)));
    text += fmt::format("  const Scalar row_active[] = {{{}}};\n", fmt::join(active, ", "));
    if (solved || responds)
      text += fmt::format("  const Scalar row_regularization[] = {{\n      {}}};\n", wrapped(regularization, 6));
    if (supported) text += fmt::format("  const Scalar row_weight[] = {{\n      {}}};\n", wrapped(weights, 6));
  }
  bool limbs_unsaid = true;
  for (const ir::ConstraintStep& s : steps) {
    const std::string by = s.by_limbs() ? "_by_limbs" : "";
    const std::string of_tree = s.by_limbs() ? "branches, " + name(s.jacobian)
                                             : fmt::format("{}, {}, {}", name(s.jacobian), name(s.factor), name(s.pivots));
    if (s.by_limbs() && std::exchange(limbs_unsaid, false))
      text += limbs.empty() ? fmt::format("  const dalembert::LimbsInArrays<Scalar> branches{{{}, {}, {}}};\n", name(s.gain),
                                          name(s.joint), name(s.pivots))
                            : limbs;
    if (s.kind == ir::ConstraintStep::Kind::delassus) {
      text +=
          fmt::format("  dalembert::delassus{}<nv, ConstraintsOfScene>({}, {}, {});\n", by, of_tree, name(s.room), name(s.to));
      continue;
    }
    if (s.by_wrenches()) {
      if (axes.empty()) text += fmt::format("  const dalembert::AxesInArray<Scalar> axes{{{}}};\n", name(s.axes));
      text += axes + fmt::format(
                         "  workspace.{} = dalembert::support_by_wrenches<nv, ConstraintsOfScene>(\n"
                         "      axes, {}, row_active, row_weight, {}, {});\n",
                         own_name(code, "support_status"), name(s.jacobian), name(s.forces), name(s.to));
      continue;
    }
    if (s.kind == Kind::support) {
      text += fmt::format(
          "  workspace.{} = dalembert::support<nv, ConstraintsOfScene, dalembert::Undriven<{}>>(\n"
          "      {}, row_active, row_weight, {}, {});\n",
          own_name(code, "support_status"), fmt::join(s.undriven, ", "), name(s.jacobian), name(s.forces), name(s.to));
      continue;
    }
    if (s.kind == Kind::respond) {
      text += fmt::format(
          "  dalembert::respond<nv, ConstraintsOfScene, {}, {}>({}, {}, row_active, row_regularization,\n      {}, {});\n",
          s.of_forces, s.inverted, name(s.jacobian), name(s.inverse), name(s.room), name(s.to));
      if (s.plain >= 0) text += fmt::format("  dalembert::without_padding<nv>({}, {});\n", name(s.to), name(s.plain));
      if (s.forces >= 0)
        text += fmt::format("  dalembert::response_of_forces<nv, ConstraintsOfScene, Scalar>({}, {});\n", name(s.room),
                            name(s.forces));
      continue;
    }
    if (s.kind == Kind::derive) {
      if (s.to >= 0)
        text += fmt::format("  dalembert::derive_accelerations<nv, ConstraintsOfScene, Scalar>({}, {}, {}, {});\n", s.first,
                            name(s.changes), name(s.room), name(s.to));
      if (s.forces >= 0)
        text += fmt::format("  dalembert::derive_forces<nv, ConstraintsOfScene, Scalar>({}, {}, {}, {});\n", name(s.efforts),
                            name(s.changes), name(s.room), name(s.forces));
      const auto or_none = [&](int array) { return array < 0 ? std::string("nullptr") : name(array); };
      if (s.turning_rows > 0)
        text +=
            fmt::format("  dalembert::derive_turning<nv, ConstraintsOfScene, {}, Scalar>({}, {}, {}, {},\n      {}, {}, {});\n",
                        s.turning_rows, name(s.left), name(s.turned), name(s.inverse), name(s.room), name(s.turning_room),
                        or_none(s.to), or_none(s.forces));
      continue;
    }
    const bool impact = s.kind == ir::ConstraintStep::Kind::impact;
    text += fmt::format(
        "  workspace.{} = dalembert::{}{}<nv, ConstraintsOfScene, CoordinateTree>(\n"
        "      {}, {}, row_active, row_regularization,\n      {}, {}, {}{});\n",
        own_name(code, impact ? "impact_status" : "constraint_status"), impact ? "solve_impact" : "solve_constrained", by,
        of_tree, name(s.right), name(s.room), name(s.forces), name(s.to), s.response >= 0 ? ", " + name(s.response) : "");
  }
  return text;
}

std::vector<std::string> constraint_includes(const CodeInput& code) {
  using Kind = ir::ConstraintStep::Kind;
  std::set<std::string> headers;
  for (const ir::ConstraintStep& step : code.algorithm.steps_of<ir::ConstraintStep>()) {
    const bool response = step.kind == Kind::respond || step.kind == Kind::derive;
    headers.insert(response ? "constraint_response" : step.kind == Kind::support ? "constraint_support" : "constraints");
  }
  return {headers.begin(), headers.end()};
}

bool solves(const CodeInput& code) {
  const std::vector<ir::MatrixStep> steps = code.algorithm.steps_of<ir::MatrixStep>();
  return std::any_of(steps.begin(), steps.end(),
                     [](const ir::MatrixStep& s) { return s.kind == ir::MatrixStep::Kind::factor; });
}

std::string solve_definition(const CodeInput& code) {
  if (code.algorithm.factor < 0) return "";
  return fmt::format(
      "bool {}(Scalar* b, int columns, int stride, const Workspace& workspace) noexcept {{\n"
      "{}"
      "  return dalembert::solve<nv>(chains, workspace.{}, b, columns, stride);\n"
      "}}\n\n",
      own_name(code, "solve"), chains_text(ir::coordinate_tree(code.tree)),
      code.algorithm.arrays[static_cast<size_t>(code.algorithm.factor)].name);
}

namespace {

const ir::OutputArray& array_of(const CodeInput& code, int index) { return code.algorithm.arrays[static_cast<size_t>(index)]; }

}  // namespace

std::string status_statement(const CodeInput& code, const std::string& check) {
  const ir::Guard& guard = *code.algorithm.guard;
  std::string read;
  for (const int array : {guard.factor, guard.gain, guard.joint, guard.pivots, guard.diagonal})
    if (array >= 0) read += fmt::format(", workspace.{}", array_of(code, array).name);
  return above_text(ir::coordinate_tree(code.tree)) +
         fmt::format("  workspace.{} = dalembert::{}coordinate_above{});\n", function_of(code).own_name("status"), check, read);
}

std::string clear_statements(const CodeInput& code) {
  std::string text;
  for (const int index : code.algorithm.guard->arrays) {
    const ir::OutputArray& array = array_of(code, index);
    text += fmt::format("  dalembert::clear_unless_ok<{}>(workspace.{}, workspace.{});\n", array.rows * array.columns,
                        function_of(code).own_name("status"), array.name);
  }
  return text;
}

std::string guard_statements(const CodeInput& code) {
  const std::optional<ir::Guard>& guard = code.algorithm.guard;
  if (!guard) return "";
  if (guard->pivots < 0) return clear_statements(code);
  return status_statement(code, guard->factor >= 0 ? "factor_status<nv>(" : "factor_status_by_gains<nv>(") +
         clear_statements(code);
}

std::string section_declaration(const CodeInput& section) {
  return fmt::format("static void {}({}, Workspace& workspace) noexcept;\n", section.algorithm.section.name,
                     parameters_of(section));
}

std::string next_section_call(const CodeInput& section) {
  if (!section.next) return "";
  const ir::Section& next = section.next->algorithm.section;
  return fmt::format("  {}(q, v, workspace.{}, workspace);\n", next.name, array_of(*section.next, next.accelerations).name);
}

int element_index(const ir::OutputArray& array, int row, int column) { return row + array.rows * column; }

}  // namespace dalembert::backend
