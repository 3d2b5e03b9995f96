#include "passes/project_by_rows.hpp"
#include "passes/roll_state.hpp"

namespace dalembert::passes {

void roll_projections(RollState& state) {
  const ir::KinematicTree& tree = state.tree;
  for (const ir::Projection& p : state.algorithm.projections) {
    const ir::OutputArray& array = state.array(p.array);
    ir::RolledProjection rolled{projected_bodies(tree, p, array), ir::Graph(state.options), {}};
    for (int row = 0; row < tree.base_coordinates(); ++row) {
      if (array.row(row) < 0) continue;
      ir::Copy copy(p.graph, rolled.graph);
      for (int column = 0; column < static_cast<int>(p.columns.size()); ++column) {
        const ir::NodeId node = copy.node(p.columns[static_cast<std::size_t>(column)], [&](const ir::Input& in) {
          return in.kind == ir::InputKind::state
                     ? rolled.graph.input(in)
                     : rolled.graph.constant(state.value(state.unroll.coordinate_role(in.index, in.component, row)));
        });
        if (!rolled.graph.is_constant(node, 0)) rolled.base.push_back({p.array, array.row(row), column, node});
      }
    }
    state.program.projections.push_back(std::move(rolled));
  }
}

}  // namespace dalembert::passes
