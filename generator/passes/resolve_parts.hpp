// Which coordinates and links the scene's parts of results are.
#pragma once

#include "ir/kinematic_tree.hpp"
#include "ir/scene.hpp"

namespace dalembert::passes {

// Names, patterns and subtrees become coordinates of v and links. Unless `base` says otherwise the base's coordinates are
// asked for where nothing but `base: true` stands, and where a subtree is the base link's. Throws InputError where nothing is
// left, or where a link has no columns.
void resolve_parts(ir::Scene& scene, const ir::KinematicTree& tree);

}  // namespace dalembert::passes
