// Whether a tree's numbers leave room for what is computed from them.
#pragma once

#include <string>

#include "ir/kinematic_tree.hpp"
#include "ir/scene.hpp"

namespace dalembert::passes {

// Throws InputError naming the joints (or the base) whose placement, inertia, losses, pitch or mimic relation holds a number
// larger than ir/magnitudes.hpp says, or none at all because a sum has overflowed, loops and gravity. What a scene's text says
// has been looked at number by number when it was read (frontend/scene_values.cpp). `file`: the URDF, for the diagnostics.
void check_magnitudes(const ir::KinematicTree& tree, const ir::Scene& scene, const std::string& file);

}  // namespace dalembert::passes
