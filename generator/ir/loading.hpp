// What a robot carries at run time, and what pulls it down, as members of a workspace have it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "ir/kinematic_tree.hpp"

namespace dalembert::ir {

// What is empty is as in a new workspace: no payloads, and the scene's gravity.
struct Loading {
  std::vector<Inertia> payloads{};           // in the links' frames, in the scene's order; or none
  std::optional<Eigen::Vector3d> gravity{};  // m/s², world axes: of a scene that gives it at run time

  bool empty() const { return payloads.empty() && !gravity; }
};

}  // namespace dalembert::ir
