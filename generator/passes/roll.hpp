// Rolling: an algorithm on one tree as loops over the segments of a plan.
//
// Every sweep's graph is copied once per segment. An input that is constant at every body of the segment, as the unrolled
// program shows, becomes a number or a column of a table; roles become values kept per slot, and sweeps of a level that pay
// together become one loop. Then everything that no result reaches is dropped, segment by segment, and values get their places.
#pragma once

#include "ir/algorithm.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/plan.hpp"
#include "ir/rolled.hpp"
#include "ir/scene.hpp"
#include "passes/unroll.hpp"

namespace dalembert::passes {

// `unroll`: of the same algorithm and tree. The plan must be of the rolled form.
ir::RolledProgram roll(const ir::Algorithm& algorithm, Unroll& unroll, const ir::KinematicTree& tree, const ir::Scene& scene,
                       const ir::Plan& plan, const ir::Graph::Options& options);

}  // namespace dalembert::passes
