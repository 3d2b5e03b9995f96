// How constraints act at run time, contacts in order and then loops, as members of a workspace have it.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace dalembert::ir {

// What is empty is as in a new workspace: all act, and nothing gives way.
struct Acting {
  std::vector<bool> active{};                   // per constraint
  std::vector<double> restitution{};            // per constraint, of impacts
  Eigen::VectorXd regularization{}, weights{};  // per row: of J M⁻¹ Jᵀ, and of forces in inverse dynamics
};

}  // namespace dalembert::ir
