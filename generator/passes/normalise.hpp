// Turns frames so that every joint axis is z, and moves inertial parameters towards the base.
#pragma once

#include "ir/kinematic_tree.hpp"
#include "ir/normal_tree.hpp"

namespace dalembert::passes {

struct NormaliseOptions {
  bool move_parameters = true;
};

// Nothing changes in the results: a rotation of frames is a renaming, and mass on a revolute joint's axis, like the rotational
// inertia behind a prismatic joint, has the same motion on either side of the joint.
ir::NormalTree normalise(const ir::KinematicTree& tree, const NormaliseOptions& options = {});

}  // namespace dalembert::passes
