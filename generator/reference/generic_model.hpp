// From the compiler's tree to the generic engine's model, in any scalar.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <dalembert/generic/model.hpp>

#include "ir/kinematic_tree.hpp"
#include "ir/scene.hpp"

namespace dalembert {

template <class S>
Inertia<S> to_generic(const ir::Inertia& inertia) {
  return {S(inertia.mass), inertia.com.cast<S>(), inertia.inertia.cast<S>()};
}

// The tree holds doubles: rotations and axes are orthonormal to 1e-16 only, and in longer scalars they stay as they are, so
// that generated code and every scalar of the generic engine compute with the same numbers.
// gravity: acceleration of free fall in world axes, m/s².
template <class S>
generic::Model<S> to_generic(const ir::KinematicTree& tree, const Eigen::Vector3d& gravity,
                             ir::Coriolis coriolis = ir::Coriolis::balance) {
  generic::Model<S> model;
  model.coriolis = coriolis == ir::Coriolis::balance ? generic::Coriolis::balance : generic::Coriolis::christoffel;
  model.floating_base = tree.base_coordinates() > 0;
  model.base = to_generic<S>(tree.base);
  model.gravity = gravity.cast<S>();
  for (const ir::Body& body : tree.bodies)
    model.bodies.push_back({body.parent, !body.turns(), body.axis.cast<S>(), body.placement.linear().cast<S>(),
                            body.placement.translation().cast<S>(), to_generic<S>(body.inertia), S(body.armature),
                            S(body.damping), S(body.friction), S(body.spring.k), S(body.spring.rest),
                            body.turns() ? S(body.slide_per_unit()) : S(0), body.of_quaternion() ? body.part : -1, body.parts});
  const std::vector<int> coordinates = tree.coordinates();
  const auto driven = [](const ir::Body& body) { return body.driven(); };
  if (std::any_of(tree.bodies.begin(), tree.bodies.end(), driven))
    for (size_t k = 0; k < tree.bodies.size(); ++k) {
      const ir::Body& body = tree.bodies[k];
      model.coordinates.push_back({coordinates[k], S(body.driven() ? body.multiplier : 1), S(body.driven() ? body.offset : 0)});
    }
  return model;
}

}  // namespace dalembert
