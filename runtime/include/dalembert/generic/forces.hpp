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

// τ = M v̇ + C v + g by recursive Newton-Euler: neither M nor C is formed, gravity is an upward acceleration of the base.
// v_dot: as v. Armature, damping and friction are included.
template <class S>
VectorX<S> expanded_newton_euler(const Model<S>& model, const Kinematics<S>& kinematics, const VectorX<S>& q,
                                 const VectorX<S>& v, const VectorX<S>& v_dot) {
  const int base = model.base_rows();
  Vector6<S> base_acceleration = Vector6<S>::Zero();
  if (model.floating_base) base_acceleration = v_dot.template head<6>();
  base_acceleration.template head<3>() -= gravity_in_base(model, q);

  // F = A V̇ − ad(V)ᵀ A V; V̇_k = (ᵖAd_k)⁻¹ V̇_p + E_k q̈_k + ad(V_k) E_k q̇_k
  const auto body_wrench = [](const Inertia<S>& inertia, const Vector6<S>& twist, const Vector6<S>& acceleration) {
    const Matrix6<S> A = inertia_matrix(inertia);
    return Vector6<S>(A * acceleration - ad(twist).transpose() * (A * twist));
  };
  std::vector<Vector6<S>> accelerations(model.bodies.size()), wrenches(model.bodies.size());
  for (int k = 0; k < model.joints(); ++k) {
    const size_t at = static_cast<size_t>(k);
    const int parent = model.bodies[at].parent;
    const BodyKinematics<S>& at_k = kinematics.bodies[at];
    accelerations[at] = at_k.Ad_inverse * (parent < 0 ? base_acceleration : accelerations[static_cast<size_t>(parent)]) +
                        at_k.E * v_dot[base + k] + ad(at_k.V) * (at_k.E * v[base + k]);
    wrenches[at] = body_wrench(model.bodies[at].inertia, at_k.V, accelerations[at]);
  }
  VectorX<S> tau = joint_forces<S>(model, kinematics, body_wrench(model.base, kinematics.base_twist, base_acceleration),
                                   std::move(wrenches));
  for (int k = 0; k < model.joints(); ++k) {
    const Body<S>& body = model.bodies[static_cast<size_t>(k)];
    const S rate = v[base + k], sign = rate > S(0) ? S(1) : rate < S(0) ? S(-1) : S(0);
    tau[base + k] += body.armature * v_dot[base + k] + body.damping * rate + body.friction * sign;
  }
  return tau;
}

}  // namespace dalembert::generic
