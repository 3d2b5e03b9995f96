// What shapes the emitted code may have; and one of them laid out, limbs side by side.
#pragma once

#include "ir/algorithm.hpp"
#include "ir/graph.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/plan.hpp"
#include "ir/scene.hpp"

namespace dalembert::passes {

// The forms that come into question: one where the options say which or nothing else makes sense. `straight`: operations of the
// straight form.
std::vector<ir::Form> forms(const ir::KinematicTree& tree, const ir::Scene& scene, const ir::Operations& straight,
                            const ir::CompileOptions& options);

// Per body, in which of the algorithm's matrices of pairs it has a row, as a number: limbs end where it changes. Empty where
// all bodies have rows in all.
std::vector<int> rows_in_pairs(const ir::Algorithm& algorithm, const ir::KinematicTree& tree);

// Tasks where the scene asks for them, and for the rolled form the segments, lanes and slots of all bodies. `rows`:
// rows_in_pairs().
ir::Plan plan(const ir::KinematicTree& tree, const ir::Scene& scene, ir::Form form, const ir::CompileOptions& options,
              const std::vector<int>& rows = {});

}  // namespace dalembert::passes
