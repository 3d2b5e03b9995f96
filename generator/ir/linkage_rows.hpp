// Rows of a linkage's loops, as scalar expressions: what generated code follows and closes them by.
//
// Rows J are those of the scene's loops as rows (docs/scene.md): of the second link against the first, along the axes of the
// frame on the first, at the point of the second. They read the joints between the two links alone.
#pragma once

#include <vector>

#include "ir/graph.hpp"

namespace dalembert::ir {

struct KinematicTree;
struct Linkage;

// Inputs of the graph: positions, by their place in q, and velocities, by their column. Columns: the dependent joints, then the
// independent ones. As many rows as dependent joints.
struct LinkageRows {
  Graph graph;
  std::vector<NodeId> error;                        // how far a row is from closed, m or rad
  std::vector<std::vector<NodeId>> jacobian, rate;  // J and J', row by row

  std::vector<NodeId> at_rest() const;  // error and J
  std::vector<NodeId> moving() const;   // J'
};
LinkageRows linkage_rows(const Linkage& linkage, const KinematicTree& tree);

}  // namespace dalembert::ir
