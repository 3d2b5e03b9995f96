// Robots with what they carry.
#pragma once

#include "ir/kinematic_tree.hpp"
#include "ir/loading.hpp"
#include "ir/scene.hpp"

namespace dalembert::reference {

// A compact payload for the index-th of the links that carry one, some half as heavy as a link is on average, its principal
// axes askew.
ir::Inertia make_payload(const ir::KinematicTree& tree, int index);

// The robot so loaded: payloads in the tree, gravity in the scene.
void load(const ir::Loading& loading, ir::KinematicTree& tree, ir::Scene& scene);

}  // namespace dalembert::reference
