// Chooses the shape of the emitted code and lays limbs side by side.
#pragma once

#include "ir/graph.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/plan.hpp"
#include "ir/scene.hpp"

namespace dalembert::passes {

// `straight` are the operations of the straight form.
ir::Plan plan(const ir::KinematicTree& tree, const ir::Scene& scene, const ir::Operations& straight,
              const ir::CompileOptions& options);

}  // namespace dalembert::passes
