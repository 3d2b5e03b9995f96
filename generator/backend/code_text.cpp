#include "backend/code_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <utility>

#include "backend/literals.hpp"
#include "ir/coordinate_tree.hpp"
#include "ir/identifier.hpp"
#include "ir/run_time_inputs.hpp"

namespace dalembert::backend {

std::string input_text(const CodeInput& code, const ir::Input& input) {
  switch (input.kind) {
    case ir::InputKind::position: return fmt::format("q[{}]", input.index);
    case ir::InputKind::velocity: return fmt::format("v[{}]", input.index);
    case ir::InputKind::acceleration:
    case ir::InputKind::effort: return fmt::format("{}[{}]", code.algorithm.section.input(), input.index);
    case ir::InputKind::gravity:
    case ir::InputKind::payload:
    case ir::InputKind::wrench:
    case ir::InputKind::constraint: {
      const ir::RunTimeInput given = ir::run_time_input(code.scene, input);
      const std::string element = "workspace." + given.element(input.component);
      if (input.kind != ir::InputKind::constraint) return element;
      return fmt::format("(workspace.{}.active ? {} : Scalar(0))", given.name, element);  // what is off may be no number
    }
    case ir::InputKind::element:
      return fmt::format("workspace.{}[{}]", code.algorithm.arrays[static_cast<size_t>(input.index)].name, input.component);
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

std::string above_text(const ir::CoordinateTree& tree) {
  return fmt::format("  static constexpr int coordinate_above[] = {{{}}};\n", fmt::join(tree.above, ", "));
}

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

std::string quantities(const CodeInput& code) {
  std::vector<std::string> names;
  for (const ir::OutputArray& a : code.program.arrays)
    if (!a.internal) names.push_back(a.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string result_words(const Folder& folder, const ir::OutputArray& array) {
  const auto words = [&](const char* symbol, const std::string& shape, const char* unit, const std::string& help) {
    return fmt::format("{}{}{} [{}]: {}.", symbol, shape.empty() ? "" : ", ", shape, unit, help);
  };
  // What stands there of a result of which a part is asked for.
  const auto words_of_part = [&](const auto& row, const std::string& help, const ir::Part& part) {
    const std::string shape =
        array.columns == 1 ? std::to_string(array.rows) : fmt::format("{} x {}", array.rows, array.columns);
    return words(row.symbol, shape, row.unit,
                 fmt::format("{}. Here {}", help, ir::in_words(part, row.rows, row.columns, *folder.common().robot)));
  };
  for (const CodeInput& code : folder.functions) {
    const ir::EmittedFunction& function = function_of(code);
    for (const ir::Quantity quantity : function.quantities) {
      const ir::QuantityRow& row = ir::row_of(quantity);
      if (const ir::Part* const part = function.part(quantity); part && function.result(quantity) == array.name)
        return words_of_part(row, row.help, *part);
      if (function.result(quantity) == array.name)
        return words(row.symbol, ir::shape(row.rows, row.columns), row.unit, row.help);
    }
    for (const ir::LinkOutput& output : function.of_links) {
      const ir::LinkQuantityRow& row = ir::row_of(output.quantity);
      if (output.part && function.result(output) == array.name) return words_of_part(row, ir::help_of(output), *output.part);
      if (function.result(output) == array.name)
        return words(row.symbol, ir::shape(row.rows, row.columns), row.unit, ir::help_of(output));
    }
  }
  return fmt::format("{} x {}", array.rows, array.columns);
}

int element_index(const ir::OutputArray& array, int row, int column) { return row + array.rows * column; }

}  // namespace dalembert::backend
