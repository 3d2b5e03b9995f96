// Phase I, root to leaves: where each body is and how it moves (paper, section 4.1; eqs. 8, 33).
#pragma once

#include <dalembert/generic/model.hpp>

namespace dalembert::generic {

// Frames: "in k" means axes of body k, at its origin.
template <class S>
struct BodyKinematics {
  Transform<S> in_parent;      // pose of k in its parent
  Transform<S> in_base;        // pose of k in the base
  Matrix6<S> Ad_inverse;       // (ᵖAd_k)⁻¹
  Matrix6<S> Ad_base;          // ⁰Ad_k
  Matrix6<S> Ad_base_inverse;  // (⁰Ad_k)⁻¹
  Vector6<S> E;                // joint's twist per unit of rate, in k (eq. 33)
  Vector6<S> E_dot;       // Ė: zero but for parts of a joint with a quaternion, whose axes stand still in the last of them
  Vector6<S> V;           // twist of k, in k
  Vector6<S> V_relative;  // twist of k relative to the base, in k
  Matrix6<S> ad_parent;   // ᵖad_k = ad(E_k q̇_k): motion relative to the parent
  Matrix6<S> ad_base;     // ⁰ad_k = ad(V_relative): motion relative to the base
};

template <class S>
struct Kinematics {
  Vector6<S> base_twist;  // V of the base in base axes; zero for a fixed base
  std::vector<BodyKinematics<S>> bodies;
};

// Pose of body k in its parent when its joint stands at q (rad or m).
template <class S>
Transform<S> joint_pose(const Body<S>& body, const S& q) {
  if (body.prismatic) return {body.rotation, body.translation + body.rotation * (body.axis * q)};
  return {body.rotation * rotation_about<S>(body.axis, q), body.translation + body.rotation * (body.axis * (body.pitch * q))};
}

// Of the first body of a joint with a quaternion; q begins with its number behind the base's, w stands behind all joints'.
template <class S>
Transform<S> quaternion_pose(const Body<S>& body, const VectorX<S>& q, Eigen::Index first, Eigen::Index w) {
  const Eigen::Index turn = body.parts == 6 ? first + 3 : first;
  const Matrix3<S> rotation = rotation_of_quaternion<S>(q[turn], q[turn + 1], q[turn + 2], q[w]);
  Vector3<S> moved = Vector3<S>::Zero();
  if (body.parts == 6) moved = q.template segment<3>(first);
  return {body.rotation * rotation, body.translation + body.rotation * moved};
}

// Room for the bodies, and the base's twist.
template <class S>
Kinematics<S> kinematics_of_base(const Model<S>& model, const VectorX<S>& v) {
  Kinematics<S> result;
  result.base_twist.setZero();
  if (model.floating_base) result.base_twist = v.template head<6>();
  result.bodies.resize(model.bodies.size());
  return result;
}

// Of body k, its parent's being there. q, v: one entry per joint behind the base's (7 or none; 6 or none): driven joints are
// already expanded. Behind them in q, the w of every quaternion.
template <class S>
void update_kinematics(const Model<S>& model, const VectorX<S>& q, const VectorX<S>& v, int k, Kinematics<S>& result) {
  const Eigen::Index q_joints = model.floating_base ? 7 : 0, v_joints = model.base_rows();
  const Body<S>& body = model.bodies[static_cast<size_t>(k)];
  BodyKinematics<S>& state = result.bodies[static_cast<size_t>(k)];
  const BodyKinematics<S>* parent = body.parent < 0 ? nullptr : &result.bodies[static_cast<size_t>(body.parent)];

  if (body.part < 0) state.in_parent = joint_pose(body, S(q[q_joints + k]));
  else if (body.part > 0) state.in_parent = {body.rotation, body.translation};
  else state.in_parent = quaternion_pose(body, q, q_joints + k, q_joints + model.joints() + model.quaternions(k));
  state.in_base = parent ? parent->in_base * state.in_parent : state.in_parent;
  state.Ad_inverse = adjoint_inverse(state.in_parent);
  state.Ad_base = adjoint(state.in_base);
  state.Ad_base_inverse = adjoint_inverse(state.in_base);

  state.E.setZero();
  if (body.prismatic) {
    state.E.template head<3>() = body.axis;
  } else {
    state.E.template head<3>() = body.pitch * body.axis;
    state.E.template tail<3>() = body.axis;
  }
  // The axes of a joint with a quaternion move with its last body, not with the body that they are taken at.
  state.E_dot.setZero();
  for (int i = 1; body.part >= 0 && i < body.parts - body.part; ++i) {
    const Body<S>& later = model.bodies[static_cast<size_t>(k + i)];
    Vector6<S> axis = Vector6<S>::Zero();
    if (later.prismatic) axis.template head<3>() = later.axis;
    else axis.template tail<3>() = later.axis;
    state.E_dot += ad<S>(Vector6<S>(axis * S(v[v_joints + k + i]))) * state.E;
  }

  const Vector6<S> rate = state.E * S(v[v_joints + k]);
  state.V = state.Ad_inverse * (parent ? parent->V : result.base_twist) + rate;
  state.V_relative = rate;
  if (parent) state.V_relative += state.Ad_inverse * parent->V_relative;
  state.ad_parent = ad(rate);
  state.ad_base = ad(state.V_relative);
}

template <class S>
Kinematics<S> phase1(const Model<S>& model, const VectorX<S>& q, const VectorX<S>& v) {
  Kinematics<S> result = kinematics_of_base(model, v);
  for (int k = 0; k < model.joints(); ++k) update_kinematics(model, q, v, k, result);
  return result;
}

}  // namespace dalembert::generic
