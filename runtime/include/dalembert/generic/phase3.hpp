// Phase III, every body with every ancestor: the elements of M and C (eqs. 31 to 39).
//
// Body k sits in row and column base_rows + k. Elements of two bodies of which neither is the other's ancestor are zero
// exactly: the branch-induced sparsity.
#pragma once

#include <dalembert/generic/phase2.hpp>

namespace dalembert::generic {

// Body k's with the base and its ancestors. Armature is added to the diagonal.
template <class S>
void mass_elements(const Model<S>& model, const Kinematics<S>& kinematics, const Composites<S>& composites, int k,
                   MatrixX<S>& M) {
  const int base = model.base_rows();
  const Body<S>& body = model.bodies[static_cast<size_t>(k)];
  const BodyKinematics<S>& at_k = kinematics.bodies[static_cast<size_t>(k)];
  const Vector6<S> force = composites.bodies[static_cast<size_t>(k)].A * at_k.E;

  // M_BJ,k = ⁰Ad_k⁻ᵀ A*_k E_k ; M_JB,k = M_BJ,kᵀ
  const Vector6<S> M_BJ = at_k.Ad_base_inverse.transpose() * force;
  if (model.floating_base) {
    M.template block<6, 1>(0, base + k) = M_BJ;
    M.template block<1, 6>(base + k, 0) = M_BJ.transpose();
  }
  // M_JJ,kk = E_kᵀ A*_k E_k
  M(base + k, base + k) = at_k.E.dot(force) + body.armature;
  for (int i = body.parent; i >= 0; i = model.bodies[static_cast<size_t>(i)].parent) {
    const BodyKinematics<S>& at_i = kinematics.bodies[static_cast<size_t>(i)];
    // M_JJ,ik = (⁰Ad_i E_i)ᵀ M_BJ,k
    M(base + i, base + k) = (at_i.Ad_base * at_i.E).dot(M_BJ);
    M(base + k, base + i) = M(base + i, base + k);
  }
}

// Body k's with the base and its ancestors.
template <class S>
void coriolis_elements(const Model<S>& model, const Kinematics<S>& kinematics, const Composites<S>& composites, int k,
                       MatrixX<S>& C) {
  const int base = model.base_rows();
  const BodyKinematics<S>& at_k = kinematics.bodies[static_cast<size_t>(k)];
  const Composite<S>& subtree = composites.bodies[static_cast<size_t>(k)];
  const Vector6<S> force = subtree.A * at_k.E_dot + subtree.B * at_k.E;

  // C_BJ,k = ⁰Ad_k⁻ᵀ (A*_k Ė_k + B*_k E_k)
  const Vector6<S> C_BJ = at_k.Ad_base_inverse.transpose() * force;
  // C_JB,k = E_kᵀ (B*_k − A*_k ⁰ad_k) ⁰Ad_k⁻¹, kept as a column
  const Vector6<S> C_JB = at_k.Ad_base_inverse.transpose() * ((subtree.B - subtree.A * at_k.ad_base).transpose() * at_k.E);
  // M_JB,k as a column
  const Vector6<S> M_JB = at_k.Ad_base_inverse.transpose() * (subtree.A * at_k.E);
  if (model.floating_base) {
    C.template block<6, 1>(0, base + k) = C_BJ;
    C.template block<1, 6>(base + k, 0) = C_JB.transpose();
  }
  // C_JJ,kk = E_kᵀ (A*_k Ė_k + B*_k E_k)
  C(base + k, base + k) = at_k.E.dot(force);
  for (int i = model.bodies[static_cast<size_t>(k)].parent; i >= 0; i = model.bodies[static_cast<size_t>(i)].parent) {
    const BodyKinematics<S>& at_i = kinematics.bodies[static_cast<size_t>(i)];
    const Vector6<S> joint = at_i.Ad_base * at_i.E, joint_rate = at_i.Ad_base * (at_i.E_dot + at_i.ad_base * at_i.E);
    // C_JJ,ik = (⁰Ad_i E_i)ᵀ C_BJ,k
    C(base + i, base + k) = joint.dot(C_BJ);
    // C_JJ,ki = C_JB,k (⁰Ad_i E_i) + M_JB,k ⁰Ad_i (Ė_i + ⁰ad_i E_i)
    C(base + k, base + i) = C_JB.dot(joint) + M_JB.dot(joint_rate);
  }
}

// nv × nv, one row per joint behind the base's.
template <class S>
MatrixX<S> phase3_mass_matrix(const Model<S>& model, const Kinematics<S>& kinematics, const Composites<S>& composites) {
  const int nv = model.base_rows() + model.joints();
  MatrixX<S> M = MatrixX<S>::Zero(nv, nv);
  if (model.floating_base) M.template topLeftCorner<6, 6>() = composites.base.A;  // M_BB = A*_0
  for (int k = 0; k < model.joints(); ++k) mass_elements(model, kinematics, composites, k, M);
  return M;
}

// nv × nv.
template <class S>
MatrixX<S> phase3_coriolis_matrix(const Model<S>& model, const Kinematics<S>& kinematics, const Composites<S>& composites) {
  const int nv = model.base_rows() + model.joints();
  MatrixX<S> C = MatrixX<S>::Zero(nv, nv);
  if (model.floating_base) C.template topLeftCorner<6, 6>() = composites.base.B;  // C_BB = B*_0
  for (int k = 0; k < model.joints(); ++k) coriolis_elements(model, kinematics, composites, k, C);
  return C;
}

}  // namespace dalembert::generic
