// The paragraphs of one segment of the rolled form, and their tables of constants.
#pragma once

#include <vector>

#include "ir/kinematic_tree.hpp"
#include "ir/normal_tree.hpp"
#include "ir/plan.hpp"
#include "ir/rolled.hpp"

namespace dalembert::passes {

// Adds to `code` what the wanted quantities of `program` may need of the segment's bodies. composite_mass: of every body's
// subtree, kg.
void lower_segment(const ir::KinematicTree& tree, const ir::NormalTree& normal, const ir::Segment& segment,
                   const ir::RolledProgram& program, const std::vector<double>& composite_mass,
                   const ir::Graph::Options& options, ir::SegmentCode& code);

}  // namespace dalembert::passes
