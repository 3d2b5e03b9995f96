// What must hold whatever the input: printed, and the program aborted, where it does not.
#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "diagnostics.hpp"
#include "ir/kinematic_tree.hpp"

namespace dalembert::fuzz {

inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

// Every refusal says what is wrong and what to do.
inline void check_diagnostics(const InputError& error) {
  require(!error.diagnostics().empty(), "an InputError holds a diagnostic");
  for (const Diagnostic& diagnostic : error.diagnostics())
    require(!diagnostic.message.empty() && !diagnostic.remedy.empty(), "a diagnostic has a message and a remedy");
}

inline bool finite(const ir::Inertia& inertia) {
  return std::isfinite(inertia.mass) && inertia.com.allFinite() && inertia.inertia.allFinite();
}

// What the passes take for granted.
inline void check_tree(const ir::KinematicTree& tree) {
  require(tree.nv() > 0, "something moves");
  require(finite(tree.base), "the base's inertia is finite");
  for (int k = 0; k < tree.joints(); ++k) {
    const ir::Body& body = tree.bodies[static_cast<size_t>(k)];
    require(-1 <= body.parent && body.parent < k, "parents stand before their children");
    require(body.subtree_size >= 1 && k + body.subtree_size <= tree.joints(), "subtrees are ranges of bodies");
    require(finite(body.inertia) && body.placement.matrix().allFinite(), "inertias and placements are finite");
    require(std::abs(body.axis.norm() - 1) < 1e-9, "axes are unit vectors");
    require(std::isfinite(body.armature) && std::isfinite(body.damping) && std::isfinite(body.friction), "losses are finite");
    require(body.spring.k >= 0 && std::isfinite(body.spring.k) && std::isfinite(body.spring.rest), "springs are finite");
    require(std::isfinite(body.multiplier) && std::isfinite(body.offset), "mimic relations are finite");
    require(body.driven_by < tree.joints() && (!body.driven() || !tree.bodies[static_cast<size_t>(body.driven_by)].driven()),
            "a driver is not driven");
  }
}

}  // namespace dalembert::fuzz
