// Functions of a robot whose loops are embedded, in two: what the tree without loops has, and what becomes of it.
#pragma once

#include "ir/algorithm.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/scene.hpp"

namespace dalembert::passes {

struct EmbeddedFunction {
  ir::Algorithm algorithm;        // of the function that users call
  ir::EmittedFunction of_opened;  // what it calls
};

// `tree`: with linkages.
EmbeddedFunction embed(const ir::EmittedFunction& function, const ir::KinematicTree& tree, const ir::Scene& scene);

// The scene of the tree without loops: the same but for what is asked for, and for loops.
ir::Scene opened(const ir::Scene& scene);

}  // namespace dalembert::passes
