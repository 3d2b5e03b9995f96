// Phase II, leaves to root: inertia and bias of each subtree, as if it were frozen into its root body (eqs. 29, 30).
#pragma once

#include <dalembert/generic/phase1.hpp>

namespace dalembert::generic {

// Of the subtree that starts at a body, in that body's frame.
template <class S>
struct Composite {
  Matrix6<S> A;  // A*_k, symmetric
  Matrix6<S> B;  // B*_k
};

template <class S>
struct Composites {
  Composite<S> base;  // the whole robot; without the base's own inertia when the base is fixed
  std::vector<Composite<S>> bodies;
};

// A_k and B_k of one body that moves with the twist (eqs. 12, 13).
template <class S>
Composite<S> own_composite(const Model<S>& model, const Inertia<S>& body, const Vector6<S>& twist) {
  return {inertia_matrix(body),
          model.coriolis == Coriolis::balance ? bias_matrix(body, twist) : christoffel_bias_matrix(body, twist)};
}

// The base's own; zero when it is fixed.
template <class S>
Composite<S> base_composite(const Model<S>& model, const Kinematics<S>& kinematics) {
  if (model.floating_base) return own_composite(model, model.base, kinematics.base_twist);
  return {Matrix6<S>::Zero(), Matrix6<S>::Zero()};
}

// Adds what the subtree of body j is to its parent.
template <class S>
void accumulate(const BodyKinematics<S>& at_j, const Composite<S>& child, Composite<S>& parent) {
  // A*_k = A_k + Σ ᵏAd_j⁻ᵀ A*_j ᵏAd_j⁻¹ (29)
  parent.A += at_j.Ad_inverse.transpose() * child.A * at_j.Ad_inverse;
  // B*_k = B_k + Σ ᵏAd_j⁻ᵀ (B*_j − A*_j ᵏad_j) ᵏAd_j⁻¹ (30)
  parent.B += at_j.Ad_inverse.transpose() * (child.B - child.A * at_j.ad_parent) * at_j.Ad_inverse;
}

template <class S>
Composites<S> phase2(const Model<S>& model, const Kinematics<S>& kinematics) {
  Composites<S> result{base_composite(model, kinematics), {}};
  for (size_t k = 0; k < model.bodies.size(); ++k)
    result.bodies.push_back(own_composite(model, model.bodies[k].inertia, kinematics.bodies[k].V));
  for (size_t j = model.bodies.size(); j-- > 0;) {
    const int parent = model.bodies[j].parent;
    accumulate(kinematics.bodies[j], result.bodies[j], parent < 0 ? result.base : result.bodies[static_cast<size_t>(parent)]);
  }
  return result;
}

}  // namespace dalembert::generic
