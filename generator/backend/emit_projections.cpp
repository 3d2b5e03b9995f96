#include "backend/emit_projections.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "backend/graph_printer.hpp"
#include "backend/kept.hpp"
#include "backend/literals.hpp"
#include "ir/moved_links.hpp"
#include "ir/row_runs.hpp"

namespace dalembert::backend {
namespace {

using ir::InputKind;

// Bodies whose columns lanes give.
std::vector<int> projected_bodies(const CodeInput& code, const ir::Projection& projection) {
  std::vector<int> bodies;
  const std::vector<int> links = ir::numbers_of_links(code.tree);
  const ir::OutputArray& array = code.algorithm.arrays[static_cast<size_t>(projection.array)];
  const int columns = static_cast<int>(projection.columns.size());
  const auto asked = [&](int k) { return array.column(columns * links[static_cast<size_t>(k)]) >= 0; };
  for (int k = 0; k < code.tree.joints(); ++k)
    if (links[static_cast<size_t>(k)] >= 0 && asked(k) && (code.is_rolled() || ir::by_rows(code.tree, k))) bodies.push_back(k);
  return bodies;
}

bool has_base_rows(const CodeInput& code) { return code.is_rolled() && code.tree.base_coordinates() > 0; }

// The base's coordinates are constants: what is left of the projection's graph for its rows.
struct BaseRow {
  int row, column;
  ir::NodeId node;
};
std::vector<BaseRow> base_rows_of(const CodeInput& code, const ir::Projection& projection, ir::Graph& graph) {
  std::vector<BaseRow> elements;
  const ir::OutputArray& array = code.algorithm.arrays[static_cast<size_t>(projection.array)];
  for (int row = 0; row < base_rows(code); ++row) {
    if (array.row(row) < 0) continue;
    ir::Copy copy(projection.graph, graph);
    for (int column = 0; column < static_cast<int>(projection.columns.size()); ++column) {
      const ir::NodeId node = copy.node(projection.columns[static_cast<size_t>(column)], [&](const ir::Input& in) {
        return in.kind == InputKind::state ? graph.input(in)
                                           : graph.constant(code.rolled.base_coordinates.at({in.index, in.component, row}));
      });
      if (!graph.is_constant(node, 0)) elements.push_back({array.row(row), column, node});
    }
  }
  return elements;
}

class ProjectionWriter {
 public:
  ProjectionWriter(const CodeInput& code, const ir::Projection& projection)
      : code_(code),
        projection_(projection),
        array_(code.algorithm.arrays[static_cast<size_t>(projection.array)]),
        joints_(projection.inputs(InputKind::carried)),
        bodies_(projection.inputs(InputKind::state)) {}

  std::string run() const {
    std::string text = fmt::format("  {{  // {}\n", projection_.equation) + tables();
    if (code_.is_rolled()) text += joints() + base_statements();
    text +=
        "    const auto rows = [&](auto some, int k, int joint, Scalar* to) DALEMBERT_IN_BLOCK {\n"
        "      using V = typename decltype(some)::template Values<Scalar>;\n";
    std::vector<Sink> sinks;
    for (size_t c = 0; c < projection_.columns.size(); ++c)
      sinks.push_back({projection_.columns[c], fmt::format("some.put(to + {}, ", array_.rows * static_cast<int>(c)), ");"});
    PrintStyle style;
    style.type = "V";
    style.scalar = code_.scene.scalar;
    style.indent = "      ";
    style.flat_sums = true;
    style.name = [](ir::NodeId id) { return fmt::format("row_{}", id); };  // straight lines before have their own
    style.broadcast = [](const std::string& number) { return fmt::format("some.all(Scalar({}))", number); };
    style.input = [this](const ir::Input& in) {
      return in.kind == InputKind::state ? fmt::format("some.all({})", of_body(in, "k"))
                                         : fmt::format("some.load({} + joint)", of_joint(in));
    };
    style.input_name = [this](const ir::Input& in) {
      const ir::Role& r = code_.algorithm.roles[static_cast<size_t>(in.index)];
      const std::string suffix = ir::component_suffix(r.shape, in.component);
      return (in.kind == InputKind::state ? "body_" : "") + r.name + (suffix.empty() ? "" : "_" + suffix);
    };
    text += print(projection_.graph, sinks, style);
    return text + fmt::format("    }};\n    dalembert::project<{}>(projected, {}, runs, workspace.{}, rows, {});\n  }}\n",
                              has_driven(code_) ? "true" : "false", projected_bodies(code_, projection_).size(), array_.name,
                              has_base_rows(code_) ? "base_rows" : "dalembert::NoBaseRows{}");
  }

 private:
  int place(const std::vector<ir::Input>& inputs, const ir::Input& in) const {
    return static_cast<int>(std::find(inputs.begin(), inputs.end(), in) - inputs.begin());
  }
  const ir::OutputArray& array(int index) const { return code_.algorithm.arrays[static_cast<size_t>(index)]; }

  // `k`: a slot; of straight lines where the body's numbers begin.
  std::string of_body(const ir::Input& in, const std::string& k) const {
    if (code_.is_rolled()) return fmt::format("{}[{}]", kept(code_, in.index, in.component), k);
    return fmt::format("workspace.{}[{} + {}]", array(projection_.bodies).name, k, place(bodies_, in));
  }
  std::string of_joint(const ir::Input& in) const {
    const int number = place(joints_, in);
    if (code_.is_rolled()) return fmt::format("of_joint[{}]", number);
    return fmt::format("workspace.{} + {}", array(projection_.joints).name, number * array(projection_.joints).rows);
  }

  std::string tables() const {
    std::vector<std::string> bodies, runs;
    const std::vector<int> links = ir::numbers_of_links(code_.tree);
    for (const int k : projected_bodies(code_, projection_)) {
      for (const ir::RowRun& r : ir::row_runs(code_.tree, k, array_.row_map))
        runs.push_back(fmt::format("{{{}, {}, {}, {}}}", r.joint, r.row, r.count, r.adds));
      const int at = code_.is_rolled() ? slot_of(code_, k) : k * array(projection_.bodies).rows;
      const int columns = array_.column(static_cast<int>(projection_.columns.size()) * links[static_cast<size_t>(k)]);
      bodies.push_back(fmt::format("{{{}, {}, {}}}", at, array_.rows * columns, runs.size()));
    }
    return fmt::format(
        "    static constexpr dalembert::RowRun runs[] = {{\n        {}}};\n"
        "    static constexpr dalembert::ProjectedBody projected[] = {{\n        {}}};\n",
        wrapped(runs, 8), wrapped(bodies, 8));
  }

  // What joints have, joint after joint.
  std::string joints() const {
    std::vector<int> slots;
    for (int k = 0; k < code_.tree.joints(); ++k) slots.push_back(slot_of(code_, k));
    std::string text = fmt::format("    static constexpr int slot[] = {{{}}};\n    Scalar of_joint[{}][{}];\n",
                                   fmt::join(slots, ", "), joints_.size(), slots.size() + 8);
    text += fmt::format("    for (int i = 0; i < {}; ++i) {{\n", slots.size());
    for (size_t i = 0; i < joints_.size(); ++i)
      text += fmt::format("      of_joint[{}][i] = {}[slot[i]];\n", i, kept(code_, joints_[i].index, joints_[i].component));
    text += fmt::format(
        "    }}\n    for (Scalar(&numbers)[{0}] : of_joint)\n      for (int i = {1}; i < {0}; ++i) numbers[i] = 0;\n",
        slots.size() + 8, slots.size());
    return text;
  }

  std::string base_statements() const {
    if (!has_base_rows(code_)) return "";
    ir::Graph graph;
    std::vector<Sink> sinks;
    for (const BaseRow& e : base_rows_of(code_, projection_, graph))
      sinks.push_back({e.node, fmt::format("to[{}] = ", array_.rows * e.column + e.row), ";"});
    PrintStyle style;
    style.type = "Scalar";
    style.scalar = code_.scene.scalar;
    style.indent = "      ";
    style.input = [this](const ir::Input& in) { return of_body(in, "k"); };
    return "    const auto base_rows = [&](int k, Scalar* to) DALEMBERT_IN_BLOCK {\n" + print(graph, sinks, style) + "    };\n";
  }

  const CodeInput& code_;
  const ir::Projection& projection_;
  const ir::OutputArray& array_;
  const std::vector<ir::Input> joints_, bodies_;
};

}  // namespace

bool projects_by_rows(const CodeInput& code, const ir::Projection& projection) {
  return (code.is_rolled() || projection.bodies >= 0) && !projected_bodies(code, projection).empty();
}
bool projects_by_rows(const CodeInput& code) {
  return std::any_of(code.algorithm.projections.begin(), code.algorithm.projections.end(),
                     [&](const ir::Projection& p) { return projects_by_rows(code, p); });
}

std::string projection_statements(const CodeInput& code) {
  std::string text;
  for (const ir::Projection& p : code.algorithm.projections)
    if (projects_by_rows(code, p)) text += ProjectionWriter(code, p).run();
  return text;
}

ir::Operations base_row_operations(const CodeInput& code, const ir::Projection& projection) {
  if (!has_base_rows(code)) return {};
  ir::Graph graph;
  std::vector<ir::NodeId> roots;
  for (const BaseRow& e : base_rows_of(code, projection, graph)) roots.push_back(e.node);
  const ir::Operations each = ir::count(graph, ir::uses(graph, roots));
  ir::Operations all;
  for (size_t body = 0; body < projected_bodies(code, projection).size(); ++body) all += each;
  return all;
}

RowCounts row_counts(const CodeInput& code, const ir::Projection& projection, int lanes) {
  RowCounts counts;
  const ir::OutputArray& array = code.algorithm.arrays[static_cast<size_t>(projection.array)];
  const std::vector<int> bodies = projected_bodies(code, projection);
  if (ir::Graph graph; has_base_rows(code))
    counts.base_elements = static_cast<long>(base_rows_of(code, projection, graph).size() * bodies.size());
  for (const int k : bodies)
    for (const ir::RowRun& run : ir::row_runs(code.tree, k, array.row_map)) {
      const int rows = ir::computed_rows(run, lanes);
      counts.rows += rows;
      counts.registers += lanes > 4 && rows >= lanes ? rows / lanes : (rows + 3) / 4;
      if (run.adds) ++counts.added;
    }
  return counts;
}

}  // namespace dalembert::backend
