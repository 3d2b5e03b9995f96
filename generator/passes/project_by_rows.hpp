// Projections of straight lines: bodies of which that takes less time get their columns from lanes that run along rows, behind
// all straight lines, which leave what those are made of.
#pragma once

#include "ir/algorithm.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/program.hpp"
#include "passes/unroll.hpp"

namespace dalembert::passes {

// The bodies whose columns of a projection lanes give, of those asked for: all, of loops; of straight lines some.
std::vector<ir::ProjectedBody> projected_bodies(const ir::KinematicTree& tree, const ir::Projection& projection,
                                                const ir::OutputArray& array);

// program: `unroll`'s, which loses elements and gets what lanes read.
void project_by_rows(ir::Algorithm& algorithm, ir::Program& program, Unroll& unroll, const ir::KinematicTree& tree);

}  // namespace dalembert::passes
