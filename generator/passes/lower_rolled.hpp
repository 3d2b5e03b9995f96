// Lowers a tree to paragraphs over slots: the rolled form.
#pragma once

#include "ir/kinematic_tree.hpp"
#include "ir/normal_tree.hpp"
#include "ir/plan.hpp"
#include "ir/rolled.hpp"
#include "ir/scene.hpp"

namespace dalembert::passes {

// The same equations as lower(), as paragraphs over the slots of `plan`, which must be of the rolled form and of this tree.
// The plan's segments become code in the plan's order; what no wanted quantity reads is left out (see prune_rolled.hpp).
ir::RolledProgram lower_rolled(const ir::KinematicTree& tree, const ir::NormalTree& normal, const ir::Scene& scene,
                               const ir::Plan& plan, const ir::Graph::Options& options);

}  // namespace dalembert::passes
