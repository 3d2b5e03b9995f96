// Keys of a scene that no output asked for has anything to do with.
#pragma once

#include "diagnostics.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/scene.hpp"

namespace dalembert {

// Adds a warning for each: what a user asks for and does not get is told of. scene: checked; tree: built for it.
void warn_of_idle_keys(const ir::Scene& scene, const ir::KinematicTree& tree, Diagnostics& warnings);

}  // namespace dalembert
