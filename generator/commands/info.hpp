// `dalembert info`: the robot as the compiler sees it.
#pragma once

#include <string>

#include "pipeline.hpp"

namespace dalembert {

// The tree with its joints numbered, the order of coordinates, bodies with masses, the table from link to body, the
// sparsity of M, and the report of what was left out.
std::string describe(const Model& model);

// The same for machines: one JSON object with robot, name, base, nq, nv, joints (those with a coordinate, in order), bodies,
// workspace_bytes, quantities by name, and without_scene: the same quantities of the URDF without a scene, as the equations are
// written (empty when they cannot be computed, or the robot is too large).
std::string describe_json(const Model& model);

}  // namespace dalembert
