#include <set>
#include <tuple>

#include "passes/roll_state.hpp"

namespace dalembert::passes {

void roll_results(RollState& state) {
  const ir::KinematicTree& tree = state.tree;
  // A coordinate may have a part of two results: of a loop's two links, where one follows a joint above the other.
  std::set<std::tuple<int, int, int>> set;  // array, row or column, first element of it
  for (std::size_t n = 0; n < state.algorithm.results.size(); ++n) {
    const ir::Result& r = state.algorithm.results[n];
    if (r.layout == ir::Layout::base) continue;
    const ir::OutputArray& array = state.array(r.array);
    const bool columns = r.layout == ir::Layout::columns, driven = tree.independent_joints() < tree.joints();
    ir::JointResult result{static_cast<int>(n), r.over.is_all() && !driven && !tree.within && !array.is_part(), {}};
    for (int k = 0; k < tree.joints(); ++k) {
      if (!state.asked(r.array, !columns, k) || !r.over.contains(tree, k)) continue;
      const int of_whole = tree.base_coordinates() + state.coordinates[static_cast<std::size_t>(k)],
                row = columns ? array.column(of_whole) : array.row(of_whole);
      const bool first = set.insert({r.array, row, columns ? r.from : 0}).second;
      for (int i = 0; i < state.role(r.role).components(); ++i)
        result.elements.push_back({columns ? array.rows * row + r.from + i : row, {r.role, i, k}, first});
    }
    state.program.results.push_back(std::move(result));
  }
}

}  // namespace dalembert::passes
