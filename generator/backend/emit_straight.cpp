#include "backend/emit_straight.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>

#include "backend/code_text.hpp"
#include "backend/emit_embedded.hpp"
#include "backend/emit_projections.hpp"
#include "backend/graph_printer.hpp"
#include "backend/kernel_text.hpp"
#include "backend/literals.hpp"
#include "backend/templates.hpp"

namespace dalembert::backend {
namespace {

// Angles whose sine or cosine is needed, in the order they are met: all are computed together at the start.
class Angles {
 public:
  Angles(const ir::Program& program) : graph_(program.graph) {
    const auto uses = ir::uses(graph_, program.roots());
    for (ir::NodeId id = 0; id < graph_.size(); ++id) {
      const ir::Op op = graph_[id].op;
      if (uses[static_cast<size_t>(id)] > 0 && (op == ir::Op::sine || op == ir::Op::cosine))
        index_.try_emplace(graph_[id].a, static_cast<int>(index_.size()));
    }
  }
  int count() const { return static_cast<int>(index_.size()); }
  std::string text(ir::NodeId id) const {
    return fmt::format("{}[{}]", graph_[id].op == ir::Op::sine ? "sine" : "cosine", index_.at(graph_[id].a));
  }
  // angle, sine and cosine of every joint, as declarations.
  std::string prologue(PrintStyle style) const {
    if (index_.empty()) return "";
    const std::string room = fmt::format(
        "  constexpr int angles = {};\n  alignas(64) Scalar sine[dalembert::padded(angles)], "
        "cosine[dalembert::padded(angles)];\n",
        count());
    if (const std::vector<int> at = positions(); !at.empty())
      return fmt::format(
          "  // Sines and cosines of all angles together.\n  static constexpr int angle_at[] = {{{}}};\n{}"
          "  dalembert::sincos_at<angles>(q, angle_at, sine, cosine);\n",
          fmt::join(at, ", "), room);
    std::vector<Sink> sinks;
    for (const auto& [node, i] : index_) sinks.push_back({node, fmt::format("angle[{}] = ", i), ";"});
    std::string out = "  // Sines and cosines of all angles together.\n" + room;
    out += "  alignas(64) Scalar angle[dalembert::padded(angles)] = {};\n";
    style.heading = nullptr;
    style.indent = "    ";
    out += "  {\n" + print(graph_, sinks, style) + "  }\n";  // a scope: its names are taken again below
    return out + "  dalembert::sincos<angles>(angle, sine, cosine);\n";
  }

 private:
  // Where in q the angles are, the last one repeated to fill the largest register; empty when an angle is not simply a
  // position.
  std::vector<int> positions() const {
    std::vector<int> at(index_.size());
    for (const auto& [node, i] : index_) {
      const ir::Node& n = graph_[node];
      if (n.op != ir::Op::input || n.input.kind != ir::InputKind::position) return {};
      at[static_cast<size_t>(i)] = n.input.index;
    }
    while (at.size() % 8 != 0) at.push_back(at.back());
    return at;
  }

  const ir::Graph& graph_;
  std::map<ir::NodeId, int> index_;
};

std::string who(const CodeInput& code, const ir::Tag& tag) {
  return tag.body < 0 ? "base " + code.tree.base_link
                      : code.tree.bodies[static_cast<size_t>(tag.body)].joint + " -> " +
                            code.tree.bodies[static_cast<size_t>(tag.body)].name;
}

// Where another order than that of the equations comes back to it.
std::string return_to(const CodeInput& code, const ir::Tag& tag) {
  return tag.body == ir::all_bodies ? "  // the factors again\n" : fmt::format("  // {} again\n", comment_text(who(code, tag)));
}

// Whether most of it are products of a body's numbers and those of another that is far away in the text.
bool fills_matrices(const CodeInput& code) { return !code.algorithm.pairs.empty() || !code.algorithm.projections.empty(); }

}  // namespace

// What is computed, by the equation of the sweep, and for whom.
std::string straight_heading(const CodeInput& code, const ir::Tag& tag) {
  const std::string equation = tag.sweep < 0 ? "moments of the payloads" : code.algorithm.equation(tag);
  if (tag.body == ir::all_bodies) return fmt::format("\n  // {}\n", equation);
  return fmt::format("\n  // {}: {}\n", comment_text(who(code, tag)), equation);
}

std::string straight_statements(const CodeInput& code, const ir::Program& program) {
  if (code.algorithm.embedding) return embedded_statements(code);
  const Angles angles(program);
  PrintStyle style;
  style.type = "Scalar";
  style.scalar = code.scene.scalar;
  style.input = [&](const ir::Input& input) { return input_text(code, input); };
  style.name = [&](ir::NodeId id) { return program.names.empty() ? std::string() : program.names[static_cast<size_t>(id)]; };
  style.sine_or_cosine = [&](const ir::Graph&, ir::NodeId id) { return angles.text(id); };
  style.heading = [&](const ir::Tag& tag) { return straight_heading(code, tag); };

  std::string body;
  const ir::InputsRead read = ir::inputs_read(program, ir::uses(program.graph, program.roots()));
  if (read.positions.empty()) body += "  (void)q;\n";
  if (read.velocities.empty()) body += "  (void)v;\n";
  if (const char* input = code.algorithm.section.input(); !read.input && *input) body += fmt::format("  (void){};\n", input);
  body += angles.prologue(style);

  std::vector<Sink> sinks;
  for (const ir::OutputElement& e : program.elements) {
    const ir::OutputArray& array = program.arrays[static_cast<size_t>(e.array)];
    sinks.push_back({e.node, fmt::format("workspace.{}[{}] = ", array.name, element_index(array, e.row, e.column)), ";"});
  }
  if (sinks.empty()) body += "  (void)workspace;\n";
  style.order = program.order;
  if (!program.order.empty()) style.return_to = [&](const ir::Tag& tag) { return return_to(code, tag); };
  return body + print(program.graph, sinks, style) + projection_statements(code) + kernel_statements(code) +
         guard_statements(code) + next_section_call(code);
}

ir::Operations straight_operations(const CodeInput& code) {
  ir::Operations sum = ir::count(code.program.graph, ir::uses(code.program.graph, code.program.roots()));
  sum.sincos = (Angles(code.program).count() + 3) / 4 * 4;
  return sum;
}

std::vector<std::string> straight_includes(const CodeInput& code) {
  std::vector<std::string> headers;
  if (code.algorithm.embedding) headers.insert(headers.end(), {"linkage", "sincos"});
  if (fills_matrices(code)) headers.emplace_back("straight_line");
  if (projects_by_rows(code)) headers.emplace_back("projections");
  if (Angles(code.program).count() > 0) headers.emplace_back("sincos");
  if (solves(code) || code.algorithm.factor >= 0) headers.emplace_back("solve");
  for (const std::string& header : kernel_includes(code)) headers.push_back(header);
  return headers;
}

std::string straight_source(const CodeInput& code, const Symbol& symbol) {
  const std::string attribute = fills_matrices(code) ? "DALEMBERT_STRAIGHT_LINE " : "";
  return render("straight.cpp", {{"linkage", attribute + symbol.linkage},
                                 {"function", symbol.name},
                                 {"parameters", parameters_of(code, "const Scalar* __restrict ")},
                                 {"body", straight_statements(code, code.program)}});
}

}  // namespace dalembert::backend
