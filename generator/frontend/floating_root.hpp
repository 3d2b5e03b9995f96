// A floating joint at the root: the robot below it has a floating base.
#pragma once

#include <string>

#include "diagnostics.hpp"
#include "frontend/urdf_outline.hpp"

namespace dalembert::frontend {

// The outline's links and joints make one tree (topology_check). A floating joint with nothing but fixed joints above it is
// taken away with all that stands in the world: its child becomes the root, and `floating_root` names the joint. What is lost
// is warned about: the origin of the joint, since q gives the base's pose in the world, and links that stand there, with their
// inertia. Any other floating joint is left as a joint of the tree; so is this one where there are several of them, or where
// something else moves in the world beside it.
void take_floating_root(const std::string& file, UrdfOutline& outline, Diagnostics& warnings);

}  // namespace dalembert::frontend
