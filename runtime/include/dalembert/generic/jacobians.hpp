// Body Jacobians: the twist of a frame, in its own axes and at its origin, is J v. Their transposes make up W (eq. 17).
#pragma once

#include <dalembert/generic/phase1.hpp>

namespace dalembert::generic {

// 6 × (base rows + joints), for a frame fixed to body k (−1: the base), placed at `frame` in the body.
template <class S>
MatrixX<S> expanded_jacobian(const Model<S>& model, const Kinematics<S>& kinematics, int k, const Transform<S>& frame) {
  const int base = model.base_rows();
  const Transform<S> in_base = k < 0 ? frame : kinematics.bodies[static_cast<size_t>(k)].in_base * frame;
  const Matrix6<S> from_base = adjoint_inverse(in_base);
  MatrixX<S> J = MatrixX<S>::Zero(6, base + model.joints());
  if (model.floating_base) J.template leftCols<6>() = from_base;
  for (int i = k; i >= 0; i = model.bodies[static_cast<size_t>(i)].parent) {
    const BodyKinematics<S>& at_i = kinematics.bodies[static_cast<size_t>(i)];
    J.col(base + i) = from_base * (at_i.Ad_base * at_i.E);
  }
  return J;
}

// The wrench influence matrix W, (base rows + joints) × 6·bodies; bodies are the base (when it floats), then model.bodies.
template <class S>
MatrixX<S> expanded_wrench_influence(const Model<S>& model, const Kinematics<S>& kinematics) {
  const int count = model.moving_bodies(), first = model.joints() - count;
  MatrixX<S> W(model.base_rows() + model.joints(), 6 * count);
  for (int b = 0; b < count; ++b)
    W.template middleCols<6>(6 * b) = expanded_jacobian(model, kinematics, first + b, Transform<S>()).transpose();
  return W;
}

}  // namespace dalembert::generic
