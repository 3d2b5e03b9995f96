// The rows of a projection that a body's columns have: those of the joints above it, run by run.
#pragma once

#include <vector>

#include "ir/kinematic_tree.hpp"

namespace dalembert::ir {

// Joints whose numbers follow one another, and whose rows do. `adds`: one that is driven by another, and whose share falls on a
// row that has its driver's, or another's, already.
struct RowRun {
  int joint = 0, row = 0, count = 0;
  bool adds = false;
};
// Of the joints above a body, itself included; what adds to others comes last.
// `rows`: where each row stands in what is asked for (OutputArray::row_map), empty where all do.
std::vector<RowRun> row_runs(const KinematicTree& tree, int body, const std::vector<int>& rows = {});

// Rows that lanes compute of a run: whole registers of `lanes` (at most four, but where a run fills a wider one), the last
// overlapping the one before; of a shorter run a register of two, or a number alone.
int computed_rows(const RowRun& run, int lanes);

// A body whose columns lanes give.
struct ProjectedBody {
  int body = 0;
  int column = 0;  // its first
  std::vector<RowRun> runs;
};
// Rows that lanes compute of them, by registers of `lanes`; and the registers.
struct RowCounts {
  long rows = 0, registers = 0;
  long added = 0;  // of the rows: those that are added to others
};
RowCounts row_counts(const std::vector<ProjectedBody>& bodies, int lanes);

}  // namespace dalembert::ir
