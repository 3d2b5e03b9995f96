// A frame fixed to a body (−1: the base) and placed at `frame` in it: where it is, how it moves, and how its velocity depends
// on v.
//
// Axes. Body: along the frame's own axes, at its origin. World: along the world's axes, at the world's origin. Mixed: along the
// world's axes, at the frame's origin.
#pragma once

#include <dalembert/generic/jacobians.hpp>
#include <dalembert/generic/mass_center.hpp>

namespace dalembert::generic {

enum class Axes { body, world, mixed };

template <class S>
Transform<S> frame_pose(const Model<S>& model, const Kinematics<S>& kinematics, const VectorX<S>& q, int k,
                        const Transform<S>& frame) {
  const Transform<S> in_base = k < 0 ? frame : kinematics.bodies[static_cast<size_t>(k)].in_base * frame;
  return base_pose(model, q) * in_base;
}

// What turns the frame's twist along its own axes into one along others.
template <class S>
Matrix6<S> from_body_axes(const Transform<S>& pose, Axes axes) {
  if (axes == Axes::body) return Matrix6<S>::Identity();
  return adjoint(axes == Axes::world ? pose : Transform<S>{pose.rotation, Vector3<S>::Zero()});
}

// m/s, rad/s.
template <class S>
Vector6<S> frame_twist(const Kinematics<S>& kinematics, int k, const Transform<S>& frame) {
  return adjoint_inverse(frame) * (k < 0 ? kinematics.base_twist : kinematics.bodies[static_cast<size_t>(k)].V);
}

// 6 × (base rows + joints): the frame's twist is J v.
template <class S>
MatrixX<S> expanded_frame_jacobian(const Model<S>& model, const Kinematics<S>& kinematics, const VectorX<S>& q, int k,
                                   const Transform<S>& frame, Axes axes) {
  return from_body_axes<S>(frame_pose(model, kinematics, q, k, frame), axes) * expanded_jacobian(model, kinematics, k, frame);
}

// J̇ v: the acceleration of the frame where v̇ = 0. v: one entry per joint behind the base's.
template <class S>
Vector6<S> frame_acceleration_bias(const Model<S>& model, const Kinematics<S>& kinematics, const VectorX<S>& q,
                                   const VectorX<S>& v, int k, const Transform<S>& frame, Axes axes) {
  const Vector6<S> twist = frame_twist(kinematics, k, frame);
  Vector6<S> spatial = Vector6<S>::Zero();  // V̇_k = (ᵖAd_k)⁻¹ V̇_p + ad(V_k) E_k q̇_k, summed along the way up
  Transform<S> in_body = frame;
  for (int i = k; i >= 0; i = model.bodies[static_cast<size_t>(i)].parent) {
    const BodyKinematics<S>& at_i = kinematics.bodies[static_cast<size_t>(i)];
    spatial += adjoint_inverse(in_body) * ((ad(at_i.V) * at_i.E + at_i.E_dot) * v[model.base_rows() + i]);
    in_body = at_i.in_parent * in_body;
  }
  const Transform<S> pose = frame_pose(model, kinematics, q, k, frame);
  if (axes == Axes::mixed) {  // the derivative of [R u; R w]
    const Matrix6<S> turning = ad<S>((Vector6<S>() << Vector3<S>::Zero(), twist.template tail<3>()).finished());
    spatial += turning * twist;
  }
  return from_body_axes<S>(pose, axes) * spatial;
}

}  // namespace dalembert::generic
