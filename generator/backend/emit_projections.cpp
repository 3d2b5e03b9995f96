#include "backend/emit_projections.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "backend/graph_printer.hpp"
#include "backend/kept.hpp"
#include "backend/literals.hpp"

namespace dalembert::backend {
namespace {

using ir::InputKind;

bool has_base_rows(const CodeInput& code) { return code.is_rolled() && code.tree.base_coordinates() > 0; }

class ProjectionWriter {
 public:
  ProjectionWriter(const CodeInput& code, size_t number)
      : code_(code),
        number_(number),
        projection_(code.algorithm.projections[number]),
        array_(array(projection_.array)),
        joints_(projection_.inputs(InputKind::carried)),
        bodies_(projection_.inputs(InputKind::state)) {}

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
                              has_driven(code_) ? "true" : "false", projected_bodies(code_, number_).size(), array_.name,
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
    for (const ir::ProjectedBody& body : projected_bodies(code_, number_)) {
      for (const ir::RowRun& r : body.runs) runs.push_back(fmt::format("{{{}, {}, {}, {}}}", r.joint, r.row, r.count, r.adds));
      const int at = code_.is_rolled() ? slot_of(code_, body.body) : body.body * array(projection_.bodies).rows;
      bodies.push_back(fmt::format("{{{}, {}, {}}}", at, array_.rows * body.column, runs.size()));
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
    const ir::RolledProjection& rolled = code_.rolled.projections[number_];
    std::vector<Sink> sinks;
    for (const ir::BlockElement& e : rolled.base)
      sinks.push_back({e.node, fmt::format("to[{}] = ", array_.rows * e.column + e.row), ";"});
    PrintStyle style;
    style.type = "Scalar";
    style.scalar = code_.scene.scalar;
    style.indent = "      ";
    style.input = [this](const ir::Input& in) { return of_body(in, "k"); };
    return "    const auto base_rows = [&](int k, Scalar* to) DALEMBERT_IN_BLOCK {\n" + print(rolled.graph, sinks, style) +
           "    };\n";
  }

  const CodeInput& code_;
  const size_t number_;
  const ir::Projection& projection_;
  const ir::OutputArray& array_;
  const std::vector<ir::Input> joints_, bodies_;
};

}  // namespace

const std::vector<ir::ProjectedBody>& projected_bodies(const CodeInput& code, size_t projection) {
  return code.is_rolled() ? code.rolled.projections[projection].bodies : code.algorithm.projections[projection].by_rows;
}
bool projects_by_rows(const CodeInput& code) {
  for (size_t p = 0; p < code.algorithm.projections.size(); ++p)
    if (!projected_bodies(code, p).empty()) return true;
  return false;
}

std::string projection_statements(const CodeInput& code) {
  std::string text;
  for (size_t p = 0; p < code.algorithm.projections.size(); ++p)
    if (!projected_bodies(code, p).empty()) text += ProjectionWriter(code, p).run();
  return text;
}

}  // namespace dalembert::backend
