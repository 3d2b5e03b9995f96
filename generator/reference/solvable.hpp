// What an inverse of the mass matrix needs of a robot.
#pragma once

#include "diagnostics.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/scene.hpp"

namespace dalembert::reference {

// Throws InputError when the scene asks for something that is solved for with M, and M is singular in every state: a joint
// moves no mass, or joints and base together do not (motion_without_mass). The error names them. Of a robot that is singular in
// some states the generated code says so by its status. Where M itself is asked for and nothing that is solved for, a base that
// moves no mass is warned of.
void check_solvable(const ir::RobotDescription& robot, const ir::KinematicTree& tree, const ir::Scene& scene,
                    Diagnostics& warnings);

}  // namespace dalembert::reference
