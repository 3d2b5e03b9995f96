// The compiler's tree as MuJoCo reads it.
#pragma once

#include <string>

#include "backend/output_files.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/scene.hpp"

namespace dalembert::reporting {

// MJCF of the tree's bodies, joints, springs, dampers and armature, in the order of the tree, the base first where it moves.
// Every inertia is a placeholder.
std::string mujoco_model(const ir::KinematicTree& tree, const ir::Scene& scene);

// The code that calls MuJoCo, with the tree's inertias.
backend::OutputFile mujoco_source(const ir::KinematicTree& tree);

}  // namespace dalembert::reporting
