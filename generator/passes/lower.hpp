// Lowers a tree and a scene to one scalar program: phases I to III, body by body, with every constant in place.
#pragma once

#include "ir/kinematic_tree.hpp"
#include "ir/normal_tree.hpp"
#include "ir/program.hpp"
#include "ir/scene.hpp"

namespace dalembert::passes {

struct LowerOptions {
  ir::Graph::Options graph{};
  bool names = true;  // keep names for reading
};

// The results a scene asks for, with their shapes, in the scene's order; then the Jacobians, in the scene's order.
std::vector<ir::OutputArray> output_arrays(const ir::KinematicTree& tree, const ir::Scene& scene);

// The straight form of every output (Shin, Park and Park 2016, eq. 12-39; gravity and bias as in Featherstone 2008, ch. 5).
// `normal` is the tree in the frames of normalise(), body by body; values keep the units and frames of the outputs: kg, m, rad,
// s, the base's axes. Elements that are zero for every state are left out. Checked input cannot fail.
ir::Program lower(const ir::KinematicTree& tree, const ir::NormalTree& normal, const ir::Scene& scene,
                  const LowerOptions& options = {});

}  // namespace dalembert::passes
