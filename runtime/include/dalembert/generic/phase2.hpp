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

template <class S>
Composites<S> phase2(const Model<S>& model, const Kinematics<S>& kinematics) {
  const auto bias = [&](const Inertia<S>& body, const Vector6<S>& twist) {
    return model.coriolis == Coriolis::balance ? bias_matrix(body, twist) : christoffel_bias_matrix(body, twist);
  };
  Composites<S> result;
  if (model.floating_base) {
    result.base = {inertia_matrix(model.base), bias(model.base, kinematics.base_twist)};
  } else {
    result.base = {Matrix6<S>::Zero(), Matrix6<S>::Zero()};
  }
  for (size_t k = 0; k < model.bodies.size(); ++k)
    result.bodies.push_back({inertia_matrix(model.bodies[k].inertia), bias(model.bodies[k].inertia, kinematics.bodies[k].V)});

  for (size_t j = model.bodies.size(); j-- > 0;) {
    const int parent = model.bodies[j].parent;
    const Composite<S>& child = result.bodies[j];
    Composite<S>& whole = parent < 0 ? result.base : result.bodies[static_cast<size_t>(parent)];
    const Matrix6<S>& Ad_inverse = kinematics.bodies[j].Ad_inverse;
    // A*_k = A_k + Σ ᵏAd_j⁻ᵀ A*_j ᵏAd_j⁻¹ (29)
    whole.A += Ad_inverse.transpose() * child.A * Ad_inverse;
    // B*_k = B_k + Σ ᵏAd_j⁻ᵀ (B*_j − A*_j ᵏad_j) ᵏAd_j⁻¹ (30)
    whole.B += Ad_inverse.transpose() * (child.B - child.A * kinematics.bodies[j].ad_parent) * Ad_inverse;
  }
  return result;
}

}  // namespace dalembert::generic
