// Forces on the joints: gravity as a wrench on every body, and inverse dynamics by recursive Newton-Euler.
#pragma once

#include <dalembert/generic/phase1.hpp>

namespace dalembert::generic {

// Gravity's acceleration in base axes. The base of a robot with a fixed base is aligned with the world.
template <class S>
Vector3<S> gravity_in_base(const Model<S>& model, const VectorX<S>& q) {
  if (!model.floating_base) return model.gravity;
  return rotation_of_quaternion<S>(q[3], q[4], q[5], q[6]).transpose() * model.gravity;
}

// Sum of wrenches over each subtree, projected on the joints: τ_k = E_kᵀ Σ_{j in subtree(k)} ᵏAd_j⁻ᵀ F_j; the base's rows
// are the sum over the whole robot. Takes one wrench per body, in the body, and the base's.
template <class S>
VectorX<S> joint_forces(const Model<S>& model, const Kinematics<S>& kinematics, Vector6<S> base_wrench,
                        std::vector<Vector6<S>> wrenches) {
  const int base = model.base_rows();
  VectorX<S> tau(base + model.joints());
  for (int k = model.joints() - 1; k >= 0; --k) {
    const int parent = model.bodies[static_cast<size_t>(k)].parent;
    const BodyKinematics<S>& at_k = kinematics.bodies[static_cast<size_t>(k)];
    tau[base + k] = at_k.E.dot(wrenches[static_cast<size_t>(k)]);
    (parent < 0 ? base_wrench : wrenches[static_cast<size_t>(parent)]) +=
        at_k.Ad_inverse.transpose() * wrenches[static_cast<size_t>(k)];
  }
  if (model.floating_base) tau.template head<6>() = base_wrench;
  return tau;
}

// Wrench that holds a body against gravity: −[m g; m ρ × g], g in the body's axes.
template <class S>
Vector6<S> weight(const Inertia<S>& body, const Vector3<S>& gravity) {
  Vector6<S> result;
  result << -body.mass * gravity, -body.mass * cross_matrix<S>(body.com) * gravity;
  return result;
}

// g = −W F, F the wrenches of gravity on the bodies (eq. 17); W is applied body by body.
template <class S>
VectorX<S> expanded_gravity(const Model<S>& model, const Kinematics<S>& kinematics, const VectorX<S>& q) {
  const Vector3<S> gravity = gravity_in_base(model, q);
  std::vector<Vector6<S>> wrenches;
  for (size_t k = 0; k < model.bodies.size(); ++k)
    wrenches.push_back(weight<S>(model.bodies[k].inertia, kinematics.bodies[k].in_base.rotation.transpose() * gravity));
  return joint_forces<S>(model, kinematics, weight(model.base, gravity), std::move(wrenches));
}

// Spatial accelerations in the bodies' own axes, gravity counted as an upward acceleration of the base.
template <class S>
struct Accelerations {
  Vector6<S> base;
  std::vector<Vector6<S>> bodies;
};

// V̇_k = (ᵖAd_k)⁻¹ V̇_p + E_k q̈_k + (ad(V_k) E_k + Ė_k) q̇_k. q, v, v_dot: of every joint, behind the base's.
template <class S>
Accelerations<S> accelerations(const Model<S>& model, const Kinematics<S>& kinematics, const VectorX<S>& q, const VectorX<S>& v,
                               const VectorX<S>& v_dot) {
  const int base = model.base_rows();
  Accelerations<S> result{Vector6<S>::Zero(), std::vector<Vector6<S>>(model.bodies.size())};
  if (model.floating_base) result.base = v_dot.template head<6>();
  result.base.template head<3>() -= gravity_in_base(model, q);
  for (int k = 0; k < model.joints(); ++k) {
    const size_t at = static_cast<size_t>(k);
    const int parent = model.bodies[at].parent;
    const BodyKinematics<S>& at_k = kinematics.bodies[at];
    result.bodies[at] = at_k.Ad_inverse * (parent < 0 ? result.base : result.bodies[static_cast<size_t>(parent)]) +
                        at_k.E * v_dot[base + k] + ad(at_k.V) * (at_k.E * v[base + k]) + at_k.E_dot * v[base + k];
  }
  return result;
}

// F = A V̇ − ad(V)ᵀ A V: what a body of inertia matrix A needs to move so (eq. 11).
template <class S>
Vector6<S> body_wrench(const Matrix6<S>& A, const Vector6<S>& twist, const Vector6<S>& acceleration) {
  return A * acceleration - ad(twist).transpose() * (A * twist);
}

// The external wrench on a body (−1: the base), out of all of them, in the order of W's columns; empty: none anywhere.
template <class S>
Vector6<S> external_wrench(const Model<S>& model, const VectorX<S>& wrenches, int body) {
  if (wrenches.size() == 0) return Vector6<S>::Zero();
  return wrenches.template segment<6>(6 * (body + model.moving_bodies() - model.joints()));
}

// τ = M v̇ + C v + g − W F by recursive Newton-Euler: neither M nor C is formed, gravity is an upward acceleration of the
// base. v_dot: as v. wrenches: F, 6·bodies, or empty. Armature, damping, friction and springs are included.
template <class S>
VectorX<S> expanded_newton_euler(const Model<S>& model, const Kinematics<S>& kinematics, const VectorX<S>& q,
                                 const VectorX<S>& v, const VectorX<S>& v_dot, const VectorX<S>& wrenches = VectorX<S>()) {
  const int base = model.base_rows(), positions = model.floating_base ? 7 : 0;
  const Accelerations<S> moving = accelerations(model, kinematics, q, v, v_dot);
  std::vector<Vector6<S>> needed;
  for (size_t k = 0; k < model.bodies.size(); ++k)
    needed.push_back(body_wrench<S>(inertia_matrix(model.bodies[k].inertia), kinematics.bodies[k].V, moving.bodies[k]) -
                     external_wrench(model, wrenches, static_cast<int>(k)));
  Vector6<S> base_needed = Vector6<S>::Zero();
  if (model.floating_base)
    base_needed =
        body_wrench<S>(inertia_matrix(model.base), kinematics.base_twist, moving.base) - external_wrench(model, wrenches, -1);
  VectorX<S> tau = joint_forces<S>(model, kinematics, base_needed, std::move(needed));
  for (int k = 0; k < model.joints(); ++k) {
    const Body<S>& body = model.bodies[static_cast<size_t>(k)];
    const S rate = v[base + k], sign = rate > S(0) ? S(1) : rate < S(0) ? S(-1) : rate;  // NaN stays
    tau[base + k] += body.armature * v_dot[base + k] + body.damping * rate + body.friction * sign +
                     body.stiffness * (q[positions + k] - body.rest);
  }
  return tau;
}

}  // namespace dalembert::generic
