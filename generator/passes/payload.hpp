// Payloads: bodies given at run time, welded to links. They add to the inertial parameters of the bodies that carry them.
#pragma once

#include <map>

#include "ir/kinematic_tree.hpp"
#include "ir/normal_tree.hpp"
#include "ir/scene.hpp"
#include "passes/symbolic.hpp"

namespace dalembert::passes {

// What the scene's payloads add to the parameters of a body (−1: the base), from inputs of kind payload: parameter → node.
// Empty where the body carries none.
std::map<int, ir::NodeId> payload_parameters(ir::Graph& graph, const ir::KinematicTree& tree, const ir::NormalTree& normal,
                                             const ir::Scene& scene, int body);

}  // namespace dalembert::passes
