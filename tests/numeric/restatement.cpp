// C by another road: base axes, base origin, absolute velocities, plain sums over subtrees. A second implementation of the
// paper's C, for C is not determined by Ṁ = C + Cᵀ and C v alone.
#include "identities.hpp"
#include "scale.hpp"

namespace dalembert::testing {

namespace {

using Vector3m = Vector3<Multi>;
using Matrix3m = Matrix3<Multi>;
using Vector6m = Vector6<Multi>;
using Matrix6m = Matrix6<Multi>;

Matrix3m skew(const Vector3m& a) { return cross_matrix<Multi>(a); }

// Of a subtree, in base axes at the base's origin: inertia (m, h, I) and bias (P, D).
struct Subtree {
  Multi m = 0;
  Vector3m h = Vector3m::Zero(), P = Vector3m::Zero();
  Matrix3m I = Matrix3m::Zero(), D = Matrix3m::Zero();

  void add(const Subtree& other) {
    m += other.m;
    h += other.h;
    P += other.P;
    I += other.I;
    D += other.D;
  }
  // [m·1, −[h]; [h], I] and [0, −[P]; 0, D]
  Matrix6m inertia() const {
    Matrix6m A;
    A << Matrix3m(m * Matrix3m::Identity()), -skew(h), skew(h), I;
    return A;
  }
  Matrix6m bias() const {
    Matrix6m B;
    B << Matrix3m::Zero(), -skew(P), Matrix3m::Zero(), D;
    return B;
  }
};

Subtree one_body(const Inertia<Multi>& body, const Transform<Multi>& in_base, const Vector6m& twist) {
  const Vector3m c = in_base.rotation * body.com + in_base.translation, w = twist.tail<3>();
  const Vector3m c_dot = twist.head<3>() + w.cross(c);
  const Matrix3m Ic = in_base.rotation * body.inertia * in_base.rotation.transpose();
  Subtree result;
  result.m = body.mass;
  result.h = body.mass * c;
  result.P = body.mass * c_dot;
  result.I = Ic - body.mass * skew(c) * skew(c);
  result.D = -skew(w) * (Ic.trace() * Matrix3m::Identity() - Ic) - body.mass * skew(c) * skew(c_dot);
  return result;
}

}  // namespace

double restatement_error(const Case& robot, const Dynamics& result) {
  const Model& model = robot.model;
  const int base = model.base_rows(), n = model.joints();
  Vector q = robot.q;
  if (model.floating_base) q.head<7>() << 0, 0, 0, 0, 0, 0, 1;
  const auto poses = world_poses(model, q);

  Vector6m V_0 = Vector6m::Zero();
  if (model.floating_base) V_0 = robot.v.head<6>();
  std::vector<Vector6m> V(1, V_0), J(1, V_0), J_dot(1, V_0);  // index 0: the base, whose J and J_dot are not used
  std::vector<Subtree> subtree(1);
  if (model.floating_base) subtree[0] = one_body(model.base, poses[0], V_0);
  for (int k = 0; k < n; ++k) {
    const generic::Body<Multi>& body = model.bodies[static_cast<size_t>(k)];
    const Transform<Multi>& pose = poses[static_cast<size_t>(k + 1)];
    const Vector3m axis = pose.rotation * body.axis;
    Vector6m joint;
    if (body.prismatic) {
      joint << axis, Vector3m::Zero();
    } else {
      joint << pose.translation.cross(axis) + body.pitch * axis, axis;
    }
    Vector6m V_link = V[static_cast<size_t>(body.parent + 1)];  // axes of a joint with a quaternion turn with its last body
    for (int i = 1; body.part >= 0 && i < body.parts - body.part; ++i) {
      const generic::Body<Multi>& later = model.bodies[static_cast<size_t>(k + i)];
      const Vector3m along = pose.rotation * later.axis;
      Vector6m axis_of_later;
      if (later.prismatic) axis_of_later << along, Vector3m::Zero();
      else axis_of_later << pose.translation.cross(along), along;
      V_link += axis_of_later * robot.v[base + k + i];
    }
    const Vector6m V_parent = V[static_cast<size_t>(body.parent + 1)];
    J.push_back(joint);
    J_dot.push_back(ad(V_link) * joint);
    V.push_back(V_parent + joint * robot.v[base + k]);
    subtree.push_back(one_body(body.inertia, pose, V.back()));
  }
  for (int k = n - 1; k >= 0; --k)
    subtree[static_cast<size_t>(model.bodies[static_cast<size_t>(k)].parent + 1)].add(subtree[static_cast<size_t>(k + 1)]);

  Matrix C = Matrix::Zero(base + n, base + n);
  if (model.floating_base) C.topLeftCorner<6, 6>() = subtree[0].inertia() * ad(V_0) + subtree[0].bias();
  for (int k = 0; k < n; ++k) {
    const size_t at = static_cast<size_t>(k + 1);
    const Matrix6m A = subtree[at].inertia(), B = subtree[at].bias();
    const Vector6m F = A * J[at], G = A * J_dot[at] + B * J[at], H = B.transpose() * J[at];
    if (model.floating_base) {
      C.block<6, 1>(0, base + k) = G;
      C.block<1, 6>(base + k, 0) = (ad(V_0).transpose() * F + H).transpose();
    }
    for (int i = k; i >= 0; i = model.bodies[static_cast<size_t>(i)].parent) {
      const size_t above = static_cast<size_t>(i + 1);
      C(base + k, base + i) = F.dot(J_dot[above]) + H.dot(J[above]);
      C(base + i, base + k) = G.dot(J[above]);
    }
  }
  return relative_error(C, result.coriolis_matrix, Scale<Multi>(result, robot.v).coriolis_matrix);
}

}  // namespace dalembert::testing
