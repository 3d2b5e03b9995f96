// Turns frames so that every joint axis is z, slides them along it, and moves inertial parameters towards the base.
#pragma once

#include "ir/kinematic_tree.hpp"
#include "ir/normal_tree.hpp"
#include "ir/scene.hpp"

namespace dalembert::passes {

struct NormaliseOptions {
  bool move_parameters = true;
  bool slide_origins = true;  // along the joints' axes, where it saves operations; M and C also get more exact, g and bias not
};

// What these outputs ask for: frames slide where M or C is among them.
NormaliseOptions normalise_options(const ir::Scene& scene, bool move_parameters);

// Nothing changes in the results: another frame of a body is a renaming, and mass on the axis of a joint that turns, like the
// rotational inertia behind one that slides, has the same motion on either side of the joint.
ir::NormalTree normalise(const ir::KinematicTree& tree, const NormaliseOptions& options = {});

}  // namespace dalembert::passes
