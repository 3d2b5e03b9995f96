// What an inverse of the mass matrix needs of a robot.
#pragma once

#include "diagnostics.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/scene.hpp"

namespace dalembert::passes {

// Throws InputError when the scene asks for something that is solved for with M, and M is singular in every state, because a
// joint moves no mass.
void check_solvable(const ir::RobotDescription& robot, const ir::KinematicTree& tree, const ir::Scene& scene);

}  // namespace dalembert::passes
