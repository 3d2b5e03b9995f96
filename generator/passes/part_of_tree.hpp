// The bodies of which the parts of results that a function gives depend: the rest of the robot is left out.
#pragma once

#include <optional>

#include "ir/emitted_function.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/scene.hpp"

namespace dalembert::passes {

// A tree of the bodies that the function's results need, with their places in the robot's q and v; nothing where it needs them
// all, or where no part of a result is asked for. Rows and columns of M do not depend on what is above all of their joints:
// where they are all that is asked for, the topmost joints stand on a fixed base.
std::optional<ir::KinematicTree> part_of_tree(const ir::EmittedFunction& function, const ir::KinematicTree& tree,
                                              const ir::Scene& scene);

}  // namespace dalembert::passes
