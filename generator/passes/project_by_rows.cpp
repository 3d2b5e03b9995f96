#include "passes/project_by_rows.hpp"

#include <algorithm>

#include "ir/moved_links.hpp"
#include "ir/row_runs.hpp"

namespace dalembert::passes {

void project_by_rows(ir::Algorithm& algorithm, ir::Program& program, Unroll& unroll, const ir::KinematicTree& tree) {
  std::vector<int> bodies;
  const std::vector<int> links = ir::numbers_of_links(tree);
  for (int k = 0; k < tree.joints(); ++k)
    if (links[static_cast<std::size_t>(k)] >= 0 && ir::by_rows(tree, k)) bodies.push_back(k);
  if (bodies.empty() || algorithm.projections.empty()) return;
  const int base_rows = tree.base_coordinates();
  const auto array = [&](const std::string& name, int rows, int columns) {
    algorithm.arrays.push_back({name, rows, columns, true});
    return static_cast<int>(algorithm.arrays.size()) - 1;
  };
  const auto put = [&](int to, int row, int column, ir::NodeId node) {
    if (!program.graph.is_constant(node, 0)) program.elements.push_back({to, row, column, node});
  };
  for (ir::Projection& p : algorithm.projections) {
    constexpr int most_in_line = 6;  // of fewer columns straight lines are as fast, or faster
    const int columns = static_cast<int>(p.columns.size());
    if (columns <= most_in_line || algorithm.arrays[static_cast<std::size_t>(p.array)].is_part()) continue;
    std::erase_if(program.elements, [&](const ir::OutputElement& e) {
      const auto body = std::find(links.begin(), links.end(), e.column / columns);
      return e.array == p.array && e.row >= base_rows && body != links.end() &&
             ir::by_rows(tree, static_cast<int>(body - links.begin()));
    });
    const std::vector<ir::Input> of_body = p.inputs(ir::InputKind::state), of_joint = p.inputs(ir::InputKind::carried);
    const std::string name = algorithm.arrays[static_cast<std::size_t>(p.array)].name;
    constexpr int room = 8;  // registers are read from any row on
    p.bodies = array(name + "_bodies", static_cast<int>(of_body.size()), tree.joints());
    p.joints = array(name + "_joints", tree.joints() + room, static_cast<int>(of_joint.size()));
    for (const int k : bodies)
      for (std::size_t i = 0; i < of_body.size(); ++i)
        put(p.bodies, static_cast<int>(i), k, unroll.kept(of_body[i].index, of_body[i].component, k));
    for (int k = 0; k < tree.joints(); ++k)
      for (std::size_t i = 0; i < of_joint.size(); ++i)
        put(p.joints, k, static_cast<int>(i), unroll.kept(of_joint[i].index, of_joint[i].component, k));
  }
  program.arrays = algorithm.arrays;
}

}  // namespace dalembert::passes
