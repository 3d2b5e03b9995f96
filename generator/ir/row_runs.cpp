#include "ir/row_runs.hpp"

#include <algorithm>
#include <set>

namespace dalembert::ir {

std::vector<RowRun> row_runs(const KinematicTree& tree, int body, const std::vector<int>& rows) {
  std::vector<int> above;
  for (int i = body; i >= 0; i = tree.bodies[static_cast<std::size_t>(i)].parent) above.insert(above.begin(), i);
  const std::vector<int> coordinates = tree.coordinates();
  const int base = tree.base_coordinates();
  const auto row = [&](int joint) {
    const int of_whole = base + coordinates[static_cast<std::size_t>(joint)];
    return rows.empty() ? of_whole : rows[static_cast<std::size_t>(of_whole)];
  };
  std::erase_if(above, [&](int joint) { return row(joint) < 0; });
  std::vector<RowRun> runs, adding;
  std::set<int> there;
  for (const bool driven : {false, true})
    for (const int joint : above) {
      if (tree.bodies[static_cast<std::size_t>(joint)].driven() != driven) continue;
      if (!there.insert(row(joint)).second) {
        adding.push_back({joint, row(joint), 1, true});
      } else if (!driven && !runs.empty() && runs.back().joint + runs.back().count == joint &&
                 runs.back().row + runs.back().count == row(joint)) {
        ++runs.back().count;
      } else {
        runs.push_back({joint, row(joint), 1, false});
      }
    }
  runs.insert(runs.end(), adding.begin(), adding.end());
  return runs;
}

int computed_rows(const RowRun& run, int lanes) {
  const auto whole = [&](int w) { return (run.count + w - 1) / w * w; };
  if (lanes > 4 && run.count >= lanes) return whole(lanes);
  const int w = std::clamp(lanes, 2, 4);
  return run.count >= w ? whole(w) : run.count == 3 ? 4 : run.count;
}

RowCounts row_counts(const std::vector<ProjectedBody>& bodies, int lanes) {
  RowCounts counts;
  for (const ProjectedBody& body : bodies)
    for (const RowRun& run : body.runs) {
      const int rows = computed_rows(run, lanes);
      counts.rows += rows;
      counts.registers += lanes > 4 && rows >= lanes ? rows / lanes : (rows + 3) / 4;
      if (run.adds) ++counts.added;
    }
  return counts;
}

}  // namespace dalembert::ir
