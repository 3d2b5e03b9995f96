// Whether a tree's numbers leave room for what is computed from them.
#pragma once

#include <string>

#include "ir/kinematic_tree.hpp"
#include "ir/scene.hpp"

namespace dalembert::passes {

// Beyond this, products such as mass · length² · rate² come near the end of double's range; no robot is near it.
inline constexpr double largest_number = 1e60;
// The same of float, for robots that are computed in it: constants are products of at most three.
inline constexpr double largest_number_in_float = 1e12;

// Throws InputError naming the joints (or the base) whose placement, inertia, losses or mimic relation holds a larger number,
// or none at all because a sum has overflowed, and gravity. `file`: the URDF, for the diagnostics.
void check_magnitudes(const ir::KinematicTree& tree, const ir::Scene& scene, const std::string& file);

}  // namespace dalembert::passes
