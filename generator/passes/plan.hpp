// What shapes the emitted code may have; and one of them laid out, limbs side by side.
#pragma once

#include "ir/graph.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/plan.hpp"
#include "ir/scene.hpp"

namespace dalembert::passes {

// The forms that come into question: one where the options say which or nothing else makes sense. `straight`: operations of the
// straight form.
std::vector<ir::Form> forms(const ir::KinematicTree& tree, const ir::Scene& scene, const ir::Operations& straight,
                            const ir::CompileOptions& options);

// Tasks or none, and for the rolled form the segments, lanes and slots of all bodies.
ir::Plan plan(const ir::KinematicTree& tree, const ir::Scene& scene, ir::Form form, const ir::Operations& straight,
              const ir::CompileOptions& options);

}  // namespace dalembert::passes
