// The quantities a user can ask for, each in a file of its own; the rows of ir/quantities.def name these functions.
//
// Each adds to the algorithm what its quantity needs and says how `array`, which is there already with the shape of its row, is
// filled. Units and frames are those of the row.
#pragma once

#include "ir/algorithm.hpp"
#include "ir/link_quantity.hpp"
#include "ir/normal_tree.hpp"
#include "passes/builder.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

#define DALEMBERT_QUANTITY(name, ...) void describe_##name(Builder& builder, int array);
#include "ir/quantities.def"
#undef DALEMBERT_QUANTITY

void describe_link_quantity(Builder& builder, const LinkFrame& link, ir::LinkQuantity quantity, int array);

// How the function may solve equations with M: one way where the scene says which or joints are driven by others, and where it
// solves none.
std::vector<ir::Solver> solvers(const ir::EmittedFunction& function, const ir::KinematicTree& tree, const ir::Scene& scene);

// One function, section by section: its quantities, in their order, then those of links; then what waits for either.
std::vector<ir::Algorithm> describe(const ir::EmittedFunction& function, const ir::KinematicTree& tree,
                                    const ir::NormalTree& normal, const ir::Scene& scene, ir::Solver solver,
                                    const ir::Graph::Options& options, Purpose purpose = {});
// By the first of its solvers.
std::vector<ir::Algorithm> describe(const ir::EmittedFunction& function, const ir::KinematicTree& tree,
                                    const ir::NormalTree& normal, const ir::Scene& scene, const ir::Graph::Options& options);

}  // namespace dalembert::passes
