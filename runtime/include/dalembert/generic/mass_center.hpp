// The centre of mass of all that moves, and its Jacobian, in world axes.
//
// What is welded to a fixed base does not move and counts for nothing. A robot without mass has no centre: NaN.
#pragma once

#include <dalembert/generic/phase1.hpp>

namespace dalembert::generic {

// Pose of the base in the world; of a fixed base the identity.
template <class S>
Transform<S> base_pose(const Model<S>& model, const VectorX<S>& q) {
  if (!model.floating_base) return {};
  return {rotation_of_quaternion<S>(q[3], q[4], q[5], q[6]), q.template head<3>()};
}

template <class S>
struct FirstMoment {
  S mass = S(0);                           // kg
  Vector3<S> moment = Vector3<S>::Zero();  // Σ m c, world axes, about the world's origin, kg m
};

template <class S>
struct FirstMoments {
  FirstMoment<S> whole;
  std::vector<FirstMoment<S>> subtrees;  // of every body
};

// q: as of phase1().
template <class S>
FirstMoments<S> first_moments(const Model<S>& model, const Kinematics<S>& kinematics, const VectorX<S>& q) {
  const Transform<S> base = base_pose(model, q);
  const auto of = [](const Inertia<S>& body, const Transform<S>& pose) {
    return FirstMoment<S>{body.mass, body.mass * (pose.rotation * body.com + pose.translation)};
  };
  FirstMoments<S> sums;
  if (model.floating_base) sums.whole = of(model.base, base);
  for (size_t k = 0; k < model.bodies.size(); ++k)
    sums.subtrees.push_back(of(model.bodies[k].inertia, base * kinematics.bodies[k].in_base));
  for (size_t k = model.bodies.size(); k-- > 0;) {
    const int parent = model.bodies[k].parent;
    FirstMoment<S>& to = parent < 0 ? sums.whole : sums.subtrees[static_cast<size_t>(parent)];
    to.mass += sums.subtrees[k].mass;
    to.moment += sums.subtrees[k].moment;
  }
  return sums;
}

// In the world, m.
template <class S>
Vector3<S> center_of_mass(const Model<S>& model, const Kinematics<S>& kinematics, const VectorX<S>& q) {
  const FirstMoment<S> whole = first_moments<S>(model, kinematics, q).whole;
  return whole.moment / whole.mass;
}

// q with the base at the world's origin: what does not depend on where the base is stays exact far away.
template <class S>
VectorX<S> at_origin(const Model<S>& model, VectorX<S> q) {
  if (model.floating_base) q.template head<3>().setZero();
  return q;
}

// 3 × (base rows + joints): the centre's velocity in world axes is J v. A joint moves the centre of what it carries about its
// axis or along it.
template <class S>
MatrixX<S> expanded_center_of_mass_jacobian(const Model<S>& model, const Kinematics<S>& kinematics, const VectorX<S>& q) {
  const VectorX<S> near = at_origin(model, q);
  const Transform<S> base = base_pose(model, near);
  const FirstMoments<S> sums = first_moments<S>(model, kinematics, near);
  const int rows = model.base_rows();
  MatrixX<S> J(3, rows + model.joints());
  const auto set = [&](int column, const Vector3<S>& moved) {
    for (int i = 0; i < 3; ++i) J(i, column) = moved[i];
  };
  const auto slid = [&](int column, const Vector3<S>& axis, const FirstMoment<S>& m) { set(column, m.mass * axis); };
  const auto turned = [&](int column, const Vector3<S>& axis, const FirstMoment<S>& m, const Vector3<S>& about) {
    set(column, cross_matrix<S>(axis) * (m.moment - m.mass * about));
  };
  for (int i = 0; i < rows; ++i) {
    if (i < 3) slid(i, base.rotation.col(i), sums.whole);
    else turned(i, base.rotation.col(i - 3), sums.whole, base.translation);
  }
  for (int k = 0; k < model.joints(); ++k) {
    const Body<S>& body = model.bodies[static_cast<size_t>(k)];
    const FirstMoment<S>& subtree = sums.subtrees[static_cast<size_t>(k)];
    const Transform<S> pose = base * kinematics.bodies[static_cast<size_t>(k)].in_base;
    const Vector3<S> axis = pose.rotation * body.axis;
    if (body.prismatic) slid(rows + k, axis, subtree);
    else turned(rows + k, axis, subtree, pose.translation);
    if (!body.prismatic && body.pitch != S(0)) J.col(rows + k) += body.pitch * subtree.mass * axis;
  }
  return J / sums.whole.mass;
}

}  // namespace dalembert::generic
