#include "backend/code_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stdexcept>

#include "ir/coordinate_tree.hpp"
#include "ir/identifier.hpp"

namespace dalembert::backend {

std::string input_text(const CodeInput& code, const ir::Input& input) {
  switch (input.kind) {
    case ir::InputKind::position: return fmt::format("q[{}]", input.index);
    case ir::InputKind::velocity: return fmt::format("v[{}]", input.index);
    case ir::InputKind::acceleration:
    case ir::InputKind::effort: return fmt::format("{}[{}]", function_of(code).input(), input.index);
    case ir::InputKind::gravity: return fmt::format("workspace.gravity_vector[{}]", input.component);
    case ir::InputKind::wrench:
      return fmt::format("workspace.wrench_{}[{}]",
                         ir::identifier(code.scene.wrenches.at(static_cast<size_t>(input.index)).link), input.component);
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

std::string own_name(const CodeInput& code, const std::string& name) { return function_of(code).own_name(name); }

std::string own_type(const CodeInput& code, const std::string& type) { return function_of(code).type + type; }

std::vector<std::string> vectors_of(const CodeInput& code) {
  std::vector<std::string> names{"q", "v"};
  if (*function_of(code).input()) names.emplace_back(function_of(code).input());
  return names;
}

std::string parameters_of(const CodeInput& code, const std::string& pointer) {
  return pointer + fmt::format("{}", fmt::join(vectors_of(code), ", " + pointer));
}

std::string arguments_of(const CodeInput& code) { return fmt::format("{}", fmt::join(vectors_of(code), ", ")); }

std::string matrix_statements(const CodeInput& code) {
  if (code.algorithm.steps.empty()) return "";
  const auto name = [&](int index) { return "workspace." + code.algorithm.arrays[static_cast<size_t>(index)].name; };
  const ir::CoordinateTree tree = ir::coordinate_tree(code.tree);
  std::string text = fmt::format("  static constexpr int coordinate_above[] = {{{}}};\n", fmt::join(tree.above, ", "));
  for (const ir::MatrixStep& s : code.algorithm.steps) {
    for (const ir::Chain& chain : ir::chains(tree, s.first)) {
      if (s.kind == ir::MatrixStep::Kind::invert)
        text += fmt::format("  dalembert::invert_chain<nv, {}>({}, coordinate_above, {}, {}, {});\n", chain.count, chain.first,
                            name(s.a), name(s.b), name(s.room));
      else
        text += fmt::format("  dalembert::negative_product_chain<nv>({}, {}, {}, coordinate_above, {}, {}, {});\n", chain.first,
                            chain.first + chain.count, tree.last[static_cast<size_t>(chain.first)], name(s.a), name(s.b),
                            name(s.to));
    }
    if (s.kind == ir::MatrixStep::Kind::invert)
      text += fmt::format("  dalembert::without_padding<nv>({}, {});\n", name(s.room), name(s.to));
  }
  return text;
}

std::string guard_statements(const CodeInput& code) {
  const std::optional<ir::Guard>& guard = code.algorithm.guard;
  if (!guard) return "";
  const auto array = [&](int index) -> const ir::OutputArray& { return code.algorithm.arrays[static_cast<size_t>(index)]; };
  const std::string status = own_name(code, "status");
  std::string text = fmt::format("  workspace.{} = dalembert::factor_status<{}>(workspace.{}, workspace.{});\n", status,
                                 array(guard->pivots).rows, array(guard->pivots).name, array(guard->diagonal).name);
  for (const int index : guard->arrays)
    text += fmt::format("  dalembert::clear_unless_ok<{}>(workspace.{}, workspace.{});\n",
                        array(index).rows * array(index).columns, status, array(index).name);
  return text;
}

int element_index(const ir::OutputArray& array, int row, int column) { return row + array.rows * column; }

}  // namespace dalembert::backend
