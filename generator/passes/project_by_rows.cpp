#include "passes/project_by_rows.hpp"

#include <set>

#include "ir/moved_links.hpp"
#include "ir/row_runs.hpp"

namespace dalembert::passes {

std::vector<ir::ProjectedBody> projected_bodies(const ir::KinematicTree& tree, const ir::Projection& projection,
                                                const ir::OutputArray& array) {
  std::vector<ir::ProjectedBody> bodies;
  const std::vector<int> links = ir::numbers_of_links(tree);
  for (int k = 0; k < tree.joints(); ++k) {
    const int link = links[static_cast<std::size_t>(k)];
    if (link < 0) continue;
    const int column = array.column(static_cast<int>(projection.columns.size()) * link);
    if (column >= 0) bodies.push_back({k, column, ir::row_runs(tree, k, array.row_map)});
  }
  return bodies;
}

namespace {

ir::Operations operations_of(const ir::Program& program, const std::set<int>& arrays) {
  return ir::count(program.graph, ir::uses(program.graph, program.roots(arrays)));
}

// Of two counts, the second of some of the first's nodes.
ir::Operations rest(const ir::Operations& whole, const ir::Operations& part) {
  return {whole.add - part.add, whole.multiply - part.multiply, whole.divide - part.divide, whole.sincos - part.sincos};
}

}  // namespace

void project_by_rows(ir::Algorithm& algorithm, ir::Program& program, Unroll& unroll, const ir::KinematicTree& tree) {
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
    const ir::OutputArray& to = algorithm.arrays[static_cast<std::size_t>(p.array)];
    if (columns <= most_in_line || to.is_part()) continue;
    p.by_rows = projected_bodies(tree, p, to);
    std::erase_if(p.by_rows, [&](const ir::ProjectedBody& body) { return !ir::by_rows(tree, body.body); });
    if (p.by_rows.empty()) continue;
    const ir::Operations in_line = operations_of(program, {p.array});
    std::set<int> theirs;  // first columns
    for (const ir::ProjectedBody& body : p.by_rows) theirs.insert(body.column);
    std::erase_if(program.elements, [&](const ir::OutputElement& e) {
      return e.array == p.array && e.row >= base_rows && theirs.contains(e.column / columns * columns);
    });
    const std::vector<ir::Input> of_body = p.inputs(ir::InputKind::state), of_joint = p.inputs(ir::InputKind::carried);
    const std::string name = to.name;
    constexpr int room = 8;  // registers are read from any row on
    p.bodies = array(name + "_bodies", static_cast<int>(of_body.size()), tree.joints());
    p.joints = array(name + "_joints", tree.joints() + room, static_cast<int>(of_joint.size()));
    for (const ir::ProjectedBody& body : p.by_rows)
      for (std::size_t i = 0; i < of_body.size(); ++i)
        put(p.bodies, static_cast<int>(i), body.body, unroll.kept(of_body[i].index, of_body[i].component, body.body));
    for (int k = 0; k < tree.joints(); ++k)
      for (std::size_t i = 0; i < of_joint.size(); ++i)
        put(p.joints, k, static_cast<int>(i), unroll.kept(of_joint[i].index, of_joint[i].component, k));
    program.counted.shares.push_back({{p.array}, rest(in_line, operations_of(program, {p.array, p.bodies, p.joints}))});
  }
  if (!algorithm.projections.empty()) program.arrays = algorithm.arrays;
}

}  // namespace dalembert::passes
