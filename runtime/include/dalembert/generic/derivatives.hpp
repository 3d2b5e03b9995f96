// Derivatives of inverse dynamics along the tree, analytic and recursive.
//
// Source: Singh, Russell, Wensing, "Efficient analytical derivatives of rigid-body dynamics using spatial vector algebra"
// (IEEE Robotics and Automation Letters, 2022), for the inertial frame that coincides with the base's at this instant. With
// absolute twists V and accelerations A (gravity an upward acceleration of the world), p the parent of i, × on motions, ×* on
// forces and f ×̄* m = m ×* f:
//
//   Ψ̇ᵢ = V_p × Sᵢ     Ψ̈ᵢ = A_p × Sᵢ + V_p × Ψ̇ᵢ     Ṡᵢ = Vᵢ × Sᵢ     B(I, V) = ½ [(V ×*) I + (I V) ×̄* − I (V ×)]
//   f = I A + V ×* I V − external wrench;   I_C, B_C, f_C: sums over the subtree
//
// and for j an ancestor of i, or i itself (first line), and j ≠ i (second line):
//
//   ∂τᵢ/∂qⱼ = Sᵢᵀ (2 B_Cᵢ Ψ̇ⱼ + I_Cᵢ Ψ̈ⱼ)                  ∂τᵢ/∂vⱼ = Sᵢᵀ (2 B_Cᵢ Sⱼ + I_Cᵢ (Ψ̇ⱼ + Ṡⱼ))
//   ∂τⱼ/∂qᵢ = Sⱼᵀ (2 B_Cᵢ Ψ̇ᵢ + I_Cᵢ Ψ̈ᵢ + f_Cᵢ ×̄* Sᵢ)     ∂τⱼ/∂vᵢ = Sⱼᵀ (2 B_Cᵢ Sᵢ + I_Cᵢ (Ψ̇ᵢ + Ṡᵢ))
//
// The floating base is a joint of six axes, S = 1, on a parent that rests. An external wrench turns and moves with its body,
// which is why it enters f and nothing else.
#pragma once

#include <dalembert/generic/forces.hpp>

namespace dalembert::generic {

// Both nv × nv, one row per joint behind the base's.
template <class S>
struct InverseDynamicsDerivatives {
  MatrixX<S> dq, dv;
};

namespace detail {

// A joint, all its parts, and the body behind it, in base axes at the base's origin.
template <class S>
struct MovingBody {
  using Axes = Eigen::Matrix<S, 6, Eigen::Dynamic>;
  int parent;                              // in the list of moving bodies; −1: the world, or a fixed base
  Eigen::Index row;                        // its first coordinate
  Vector6<S> V, A;                         // twist and acceleration of the body
  Axes axes, axes_dot, psi_dot, psi_ddot;  // S, Ṡ, Ψ̇, Ψ̈: a column per coordinate
  Matrix6<S> inertia, bias;                // I_C and B_C
  Vector6<S> force;                        // f_C
};

// f ×̄*: the matrix that takes a motion m to m ×* f.
template <class S>
Matrix6<S> cross_of_force(const Vector6<S>& force) {
  const Matrix3<S> f = cross_matrix<S>(force.template head<3>()), t = cross_matrix<S>(force.template tail<3>());
  Matrix6<S> result;
  result << Matrix3<S>::Zero(), -f, -f, -t;
  return result;
}

// B(I, V)
template <class S>
Matrix6<S> bias_of(const Matrix6<S>& inertia, const Vector6<S>& twist) {
  const Matrix6<S> cross = ad(twist);
  return (cross_of_force<S>(inertia * twist) - cross.transpose() * inertia - inertia * cross) / S(2);
}

template <class S>
std::vector<MovingBody<S>> moving_bodies(const Model<S>& model, const Kinematics<S>& kinematics, const VectorX<S>& q,
                                         const VectorX<S>& v, const VectorX<S>& v_dot, const VectorX<S>& wrenches) {
  const Accelerations<S> moving = accelerations(model, kinematics, q, v, v_dot);
  const Matrix6<S> still = Matrix6<S>::Identity();
  const int first = model.joints() - model.moving_bodies();
  Vector6<S> world_acceleration = Vector6<S>::Zero();
  world_acceleration.template head<3>() = -gravity_in_base(model, q);

  std::vector<MovingBody<S>> bodies;
  std::vector<int> moved_by;  // per body, from the first that moves on: which of these it is part of
  for (int k = first; k < model.joints(); ++k) {
    const bool base = k < 0;
    const size_t at = static_cast<size_t>(base ? 0 : k);
    const Matrix6<S>&to_base = base ? still : kinematics.bodies[at].Ad_base,
          &from_base = base ? still : kinematics.bodies[at].Ad_base_inverse;
    const Vector6<S> own_twist = base ? kinematics.base_twist : kinematics.bodies[at].V,
                     own_acceleration = base ? moving.base : moving.bodies[at];
    const Matrix6<S> own_inertia = inertia_matrix(base ? model.base : model.bodies[at].inertia);

    const Vector6<S> wrench = from_base.transpose() *
                              (body_wrench<S>(own_inertia, own_twist, own_acceleration) - external_wrench(model, wrenches, k));
    const bool goes_on = !base && model.bodies[at].part > 0;  // of the joint of the body before
    if (!goes_on) {
      MovingBody<S> begun;
      const int above = base ? -1 : model.bodies[at].parent - first;
      begun.parent = above < 0 ? -1 : moved_by[static_cast<size_t>(above)];
      begun.row = base ? 0 : model.base_rows() + k;
      begun.axes = base ? typename MovingBody<S>::Axes(still) : typename MovingBody<S>::Axes(6, 0);
      for (Vector6<S>* vector : {&begun.V, &begun.A, &begun.force}) vector->setZero();
      for (Matrix6<S>* matrix : {&begun.inertia, &begun.bias}) matrix->setZero();
      bodies.push_back(begun);
    }
    moved_by.push_back(static_cast<int>(bodies.size()) - 1);
    MovingBody<S>& body = bodies.back();
    body.V = to_base * own_twist;
    body.A = to_base * own_acceleration;
    if (!base) {
      body.axes.conservativeResize(6, body.axes.cols() + 1);
      body.axes.col(body.axes.cols() - 1) = to_base * kinematics.bodies[at].E;
    }
    body.inertia += from_base.transpose() * own_inertia * from_base;
    body.force += wrench;
  }
  for (MovingBody<S>& body : bodies) {
    const bool on_world = body.parent < 0;
    const Vector6<S> V_p = on_world ? Vector6<S>(Vector6<S>::Zero()) : bodies[static_cast<size_t>(body.parent)].V,
                     A_p = on_world ? world_acceleration : bodies[static_cast<size_t>(body.parent)].A;
    body.psi_dot = ad(V_p) * body.axes;
    body.psi_ddot = ad(A_p) * body.axes + ad(V_p) * body.psi_dot;
    body.axes_dot = ad(body.V) * body.axes;
    body.bias = bias_of<S>(body.inertia, body.V);
  }
  for (size_t k = bodies.size(); k-- > 0;) {
    if (bodies[k].parent < 0) continue;
    MovingBody<S>& parent = bodies[static_cast<size_t>(bodies[k].parent)];
    parent.inertia += bodies[k].inertia;
    parent.bias += bodies[k].bias;
    parent.force += bodies[k].force;
  }
  return bodies;
}

}  // namespace detail

// Of what expanded_newton_euler() gives, with its arguments. Stiffness is on the diagonal of dq, damping on that of dv;
// friction is a constant but where a joint stands still, so its derivative counts as zero; armature depends on neither q nor v.
template <class S>
InverseDynamicsDerivatives<S> expanded_derivatives(const Model<S>& model, const Kinematics<S>& kinematics, const VectorX<S>& q,
                                                   const VectorX<S>& v, const VectorX<S>& v_dot,
                                                   const VectorX<S>& wrenches = VectorX<S>()) {
  using Axes = typename detail::MovingBody<S>::Axes;
  const std::vector<detail::MovingBody<S>> bodies = detail::moving_bodies(model, kinematics, q, v, v_dot, wrenches);
  const Eigen::Index nv = model.base_rows() + model.joints();
  InverseDynamicsDerivatives<S> result{MatrixX<S>::Zero(nv, nv), MatrixX<S>::Zero(nv, nv)};
  for (const detail::MovingBody<S>& i : bodies) {
    const Matrix6<S>& I = i.inertia;
    const Matrix6<S> B = S(2) * i.bias;
    const Axes force_dq = B * i.psi_dot + I * i.psi_ddot + detail::cross_of_force<S>(i.force) * i.axes,
               force_dv = B * i.axes + I * (i.psi_dot + i.axes_dot);
    const Eigen::Index rows = i.axes.cols();
    for (const detail::MovingBody<S>* j = &i;; j = &bodies[static_cast<size_t>(j->parent)]) {
      const Eigen::Index columns = j->axes.cols();
      if (j != &i) {
        result.dq.block(j->row, i.row, columns, rows) = j->axes.transpose() * force_dq;
        result.dv.block(j->row, i.row, columns, rows) = j->axes.transpose() * force_dv;
      }
      result.dq.block(i.row, j->row, rows, columns) = i.axes.transpose() * (B * j->psi_dot + I * j->psi_ddot);
      result.dv.block(i.row, j->row, rows, columns) = i.axes.transpose() * (B * j->axes + I * (j->psi_dot + j->axes_dot));
      if (j->parent < 0) break;
    }
  }
  for (int k = 0; k < model.joints(); ++k) {
    const int row = model.base_rows() + k;
    result.dq(row, row) += model.bodies[static_cast<size_t>(k)].stiffness;
    result.dv(row, row) += model.bodies[static_cast<size_t>(k)].damping;
  }
  return result;
}

}  // namespace dalembert::generic
