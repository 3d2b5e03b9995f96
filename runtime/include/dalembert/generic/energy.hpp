// Kinetic and potential energy, body by body.
#pragma once

#include <dalembert/generic/mass_center.hpp>

namespace dalembert::generic {

// ½ Σ Vᵀ A V over the bodies, the base's when it floats, and ½ armature q̇² over the joints: ½ vᵀ M v, J. v: one entry per joint
// behind the base's.
template <class S>
S expanded_kinetic_energy(const Model<S>& model, const Kinematics<S>& kinematics, const VectorX<S>& v) {
  S twice(0);
  if (model.floating_base) twice += kinematics.base_twist.dot(inertia_matrix(model.base) * kinematics.base_twist);
  for (int k = 0; k < model.joints(); ++k) {
    const Body<S>& body = model.bodies[static_cast<size_t>(k)];
    const Vector6<S>& twist = kinematics.bodies[static_cast<size_t>(k)].V;
    const S rate = v[model.base_rows() + k];
    twice += twist.dot(inertia_matrix(body.inertia) * twist) + body.armature * rate * rate;
  }
  return twice / S(2);
}

// −Σ m γ·c over what moves, c the bodies' centres of mass in the world: zero where all of it lies in the world's origin; and
// ½ stiffness (q − rest)² of the joints' springs, J. q: as of phase1().
template <class S>
S potential_energy(const Model<S>& model, const Kinematics<S>& kinematics, const VectorX<S>& q) {
  S twice(0);
  for (int k = 0; k < model.joints(); ++k) {
    const Body<S>& body = model.bodies[static_cast<size_t>(k)];
    const S strain = q[(model.floating_base ? 7 : 0) + k] - body.rest;
    twice += body.stiffness * strain * strain;
  }
  return twice / S(2) - model.gravity.dot(first_moments<S>(model, kinematics, q).whole.moment);
}

}  // namespace dalembert::generic
