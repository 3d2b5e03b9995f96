// Which joints follow which by the scene's loops with independent joints.
#pragma once

#include "diagnostics.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/robot_description.hpp"
#include "ir/scene.hpp"

namespace dalembert::passes {

// Fills the tree's linkages and marks what follows. Loops are those of the scene, whose links the tree has, on two bodies each.
// Throws InputError where independent joints are none of a loop's, too few or too many for its rows, where a joint can neither
// follow nor be followed, and where loops cannot be closed or hold what does not tell where dependent joints are.
void embed_loops(ir::KinematicTree& tree, const ir::Scene& scene, const ir::RobotDescription& robot);

}  // namespace dalembert::passes
