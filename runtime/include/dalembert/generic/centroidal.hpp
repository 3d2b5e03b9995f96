// Momentum of all that moves, about its centre of mass and along the world's axes (Orin, Goswami and Lee 2013).
#pragma once

#include <dalembert/generic/mass_center.hpp>
#include <dalembert/generic/phase2.hpp>

namespace dalembert::generic {

// A wrench or momentum in base axes and about the base's origin, along the world's axes and about the centre of mass.
template <class S>
Vector6<S> about_center(const Transform<S>& base, const Vector3<S>& center, const Vector6<S>& in_base) {
  const Matrix3<S> to_base = base.rotation.transpose();
  return adjoint(Transform<S>{to_base, to_base * (center - base.translation)}).transpose() * in_base;
}

// A, 6 × (base rows + joints): momentum, linear part first (kg m/s, kg m²/s), is A v. A column is the momentum of the subtree
// that its coordinate moves, A*_k E_k.
template <class S>
MatrixX<S> expanded_momentum_matrix(const Model<S>& model, const Kinematics<S>& kinematics, const Composites<S>& composites,
                                    const VectorX<S>& q) {
  const VectorX<S> near = at_origin(model, q);
  const Transform<S> base = base_pose(model, near);
  const Vector3<S> center = center_of_mass<S>(model, kinematics, near);
  const int rows = model.base_rows();
  MatrixX<S> A(6, rows + model.joints());
  for (int i = 0; i < rows; ++i) A.col(i) = about_center<S>(base, center, composites.base.A.col(i));
  for (int k = 0; k < model.joints(); ++k) {
    const BodyKinematics<S>& at_k = kinematics.bodies[static_cast<size_t>(k)];
    const Vector6<S> in_base = at_k.Ad_base_inverse.transpose() * (composites.bodies[static_cast<size_t>(k)].A * at_k.E);
    A.col(rows + k) = about_center<S>(base, center, in_base);
  }
  return A;
}

// Ȧ v: the momentum's rate is A v̇ + Ȧ v, N and N m. v: one entry per joint behind the base's. Every body's wrench where v̇ = 0.
template <class S>
Vector6<S> expanded_momentum_bias(const Model<S>& model, const Kinematics<S>& kinematics, const VectorX<S>& q,
                                  const VectorX<S>& v) {
  const auto wrench = [](const Inertia<S>& body, const Vector6<S>& twist, const Vector6<S>& acceleration) {
    const Matrix6<S> A = inertia_matrix(body);
    return Vector6<S>(A * acceleration - ad(twist).transpose() * (A * twist));
  };
  Vector6<S> in_base = Vector6<S>::Zero();
  if (model.floating_base) in_base = wrench(model.base, kinematics.base_twist, in_base);
  std::vector<Vector6<S>> accelerations(model.bodies.size(), Vector6<S>::Zero());
  for (int k = 0; k < model.joints(); ++k) {
    const auto at = static_cast<size_t>(k);
    const BodyKinematics<S>& at_k = kinematics.bodies[at];
    if (const int parent = model.bodies[at].parent; parent >= 0)
      accelerations[at] = at_k.Ad_inverse * accelerations[static_cast<size_t>(parent)];
    accelerations[at] += (ad(at_k.V) * at_k.E + at_k.E_dot) * v[model.base_rows() + k];
    in_base += at_k.Ad_base_inverse.transpose() * wrench(model.bodies[at].inertia, at_k.V, accelerations[at]);
  }
  const VectorX<S> near = at_origin(model, q);
  return about_center<S>(base_pose(model, near), center_of_mass<S>(model, kinematics, near), in_base);
}

// J̇ v of the centre of mass: its acceleration is J v̇ + J̇ v, world axes, m/s². v: one entry per joint behind the base's.
template <class S>
Vector3<S> expanded_center_of_mass_bias(const Model<S>& model, const Kinematics<S>& kinematics, const VectorX<S>& q,
                                        const VectorX<S>& v) {
  S mass = model.floating_base ? model.base.mass : S(0);
  for (const Body<S>& body : model.bodies) mass += body.inertia.mass;
  return expanded_momentum_bias<S>(model, kinematics, q, v).template head<3>() / mass;
}

}  // namespace dalembert::generic
