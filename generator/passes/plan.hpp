// Chooses the shape of the emitted code and lays limbs side by side.
#pragma once

#include "ir/graph.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/plan.hpp"
#include "ir/scene.hpp"

namespace dalembert::passes {

// The form (straight or rolled), tasks or none, and for the rolled form the segments, lanes and slots of all bodies.
// `straight`: operations of the straight form, by which the choice is made where the options leave it open.
ir::Plan plan(const ir::KinematicTree& tree, const ir::Scene& scene, const ir::Operations& straight,
              const ir::CompileOptions& options);

}  // namespace dalembert::passes
