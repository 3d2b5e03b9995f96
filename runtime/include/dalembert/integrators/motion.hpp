// Where a motion leads: positions plus twists, the floating base's pose on its group.
//
// q and v as everywhere: on a floating base q has one entry more than v, begins with the base's position in the world and its
// quaternion x y z w, and v begins with the base's twist in its own axes; on a fixed base both are the joints'. All sizes may
// be fixed at compile time, and nothing allocates then. Where joints have quaternions, generated code lists them:
// `quaternion_joints`, in the order of q, which every function here takes last.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <dalembert/integrators/screws.hpp>
#include <dalembert/quaternion_joint.hpp>
#include <dalembert/spatial.hpp>

namespace dalembert::integrators {

// No joint has a quaternion.
inline constexpr std::array<QuaternionJoint, 0> no_quaternions{};

// Whether the base floats; and whether it may, as far as sizes fixed at compile time tell.
template <class Q, class V>
bool floats(const Q& q, const V& v, Eigen::Index quaternions = 0) {
  return q.size() != v.size() + quaternions;
}
template <class Q, class V>
inline constexpr bool may_float = int(Q::RowsAtCompileTime) == Eigen::Dynamic ||
                                  int(Q::RowsAtCompileTime) != int(V::RowsAtCompileTime);  // enumerations of Eigen's

namespace detail {

// The quaternion at q[at], turned by the angular step at step[from]; written to next.
template <class Q, class V>
void turn(const Q& q, const V& step, Q& next, Eigen::Index at, Eigen::Index from) {
  using Scalar = typename Q::Scalar;
  const Scalar was[4] = {q[at], q[at + 1], q[at + 2], q[at + 3]}, by[3] = {step[from], step[from + 1], step[from + 2]};
  Scalar turned[4];
  Screw<Scalar> screw;
  screw_of(square(by), screw);
  turn_quaternion(was, by, screw, turned);
  for (int i = 0; i < 4; ++i) next[at + i] = turned[i];
}

// The pose at q[at], seven entries, moved by the twist at step[from]; written to next.
template <class Q, class V>
void move_pose(const Q& q, const V& step, Q& next, Eigen::Index at, Eigen::Index from) {
  using Scalar = typename Q::Scalar;
  Scalar was[7], by[6], moved[7];
  for (int i = 0; i < 7; ++i) was[i] = q[at + i];
  for (int i = 0; i < 6; ++i) by[i] = step[from + i];
  Screw<Scalar> screw;
  screw_of(square(by + 3), screw);
  move_pose_by(was, by, screw, moved);
  for (int i = 0; i < 7; ++i) next[at + i] = moved[i];
}

// The angular step at step[into], such that turn(from, step) is the quaternion of `to`; its angle, and half that one's sine.
template <class Q, class V>
typename Q::Scalar turn_difference(const Q& from, const Q& to, V& step, Eigen::Index at, Eigen::Index into) {
  using std::atan2;
  using Scalar = typename Q::Scalar;
  const Scalar x = from[at], y = from[at + 1], z = from[at + 2], w = from[at + 3], a = to[at], b = to[at + 1], c = to[at + 2],
               d = to[at + 3];
  Eigen::Matrix<Scalar, 4, 1> turned(w * a - x * d - y * c + z * b, w * b + x * c - y * d - z * a,
                                     w * c - x * b + y * a - z * d, w * d + x * a + y * b + z * c);
  if (turned[3] < 0) turned = -turned;  // of the two ways round the shorter
  const Scalar half_sine = turned.template head<3>().norm(), angle = 2 * atan2(half_sine, turned[3]);
  // angle / sin(angle/2), or its series.
  const Scalar ratio = half_sine < Scalar(1e-6) ? 2 + half_sine * half_sine / 3 : angle / half_sine;
  step.template segment<3>(into) = ratio * turned.template head<3>();
  return angle;
}

// The twist at step[into], such that move_pose(from, step) is the pose of `to`.
template <class Q, class V>
void pose_difference(const Q& from, const Q& to, V& step, Eigen::Index at, Eigen::Index into) {
  using std::cos;
  using std::sin;
  using Scalar = typename Q::Scalar;
  const Scalar angle = turn_difference(from, to, step, at + 3, into + 3), squared = angle * angle;
  const Vector3<Scalar> turning = step.template segment<3>(into + 3);
  // (1 − angle/2 · cot(angle/2)) / angle², or its series.
  const Scalar second = squared < Scalar(1e-2) ? (1 + squared / 60 * (1 + squared / 42 * (1 + squared / 40))) / 12
                                               : (1 - angle / 2 * cos(angle / 2) / sin(angle / 2)) / squared;
  const Vector3<Scalar> apart =
      rotation_of_quaternion<Scalar>(from[at + 3], from[at + 4], from[at + 5], from[at + 6]).transpose() *
      (to.template segment<3>(at) - from.template segment<3>(at));
  const Vector3<Scalar> across = turning.cross(apart);
  step.template segment<3>(into) = apart - across / 2 + second * turning.cross(across);
}

// Calls of_pose(at, i), of_turn(at, i) and of_rest(at, i, count) for the parts of q and v in their order.
template <class Q, class V, class Joints, class Pose, class Turn, class Rest>
void each_part(const Q& q, const V& v, const Joints& joints, const Pose& of_pose, const Turn& of_turn, const Rest& of_rest) {
  Eigen::Index at = 0, i = 0;
  if constexpr (may_float<Q, V>) {
    Eigen::Index quaternions = 0;
    for (const QuaternionJoint& joint : joints) (void)joint, ++quaternions;
    if (floats(q, v, quaternions)) {
      of_pose(at, i);
      at = 7, i = 6;
    }
    for (const QuaternionJoint& joint : joints) {
      of_rest(at, i, joint.v - i);
      if (joint.slides) of_pose(joint.q, joint.v);
      else of_turn(joint.q, joint.v);
      at = joint.q + (joint.slides ? 7 : 4);
      i = joint.v + (joint.slides ? 6 : 3);
    }
  }
  of_rest(at, i, v.size() - i);
}

// The quaternion joints that a robot's dynamics know of.
template <class Dynamics>
constexpr auto quaternions_of(const Dynamics& dynamics, int) -> decltype((dynamics.quaternion_joints)) {
  return dynamics.quaternion_joints;
}
template <class Dynamics>
constexpr const std::array<QuaternionJoint, 0>& quaternions_of(const Dynamics&, long) {
  return no_quaternions;
}

}  // namespace detail

// q, moved by the twist `step` (m, rad: velocity times time, in the base's own axes): next = q · exp(step). The base turns and
// slides along a screw, as do floating joints; spherical ones turn; other joints add. A quaternion's length returns to 1 to
// first order, so that rounding never adds up. q and next may be the same; otherwise next has q's size.
template <class Q, class V, class Joints = decltype(no_quaternions)>
void move(const Q& q, const V& step, Q& next, const Joints& joints = no_quaternions) {
  detail::each_part(
      q, step, joints, [&](auto at, auto i) { detail::move_pose(q, step, next, at, i); },
      [&](auto at, auto i) { detail::turn(q, step, next, at, i); },
      [&](Eigen::Index at, Eigen::Index i, Eigen::Index count) {
        next.segment(at, count) = q.segment(at, count) + step.segment(i, count);
      });
}

// The step that leads from one q to another: to = from · exp(step), with the base and quaternions turned by at most half a
// turn; other joints subtract. The quaternions are of unit length; `step` has v's size.
template <class Q, class V, class Joints = decltype(no_quaternions)>
void difference(const Q& from, const Q& to, V& step, const Joints& joints = no_quaternions) {
  detail::each_part(
      from, step, joints, [&](auto at, auto i) { detail::pose_difference(from, to, step, at, i); },
      [&](auto at, auto i) { detail::turn_difference(from, to, step, at, i); },
      [&](Eigen::Index at, Eigen::Index i, Eigen::Index count) {
        step.segment(i, count) = to.segment(at, count) - from.segment(at, count);
      });
}

// The rate of `step` when q · exp(step) moves with v: dexp⁻¹ of −step, applied to v, to third order in the step, which is what
// a method of fourth order needs (Munthe-Kaas, BIT 38, 1998; Hairer, Lubich, Wanner, Geometric Numerical Integration, IV.8).
template <class Q, class V, class Joints = decltype(no_quaternions)>
V rate_of_step(const Q& q, const V& step, const V& v, const Joints& joints = no_quaternions) {
  using Scalar = typename V::Scalar;
  V rate = v;
  detail::each_part(
      q, v, joints,
      [&](auto, auto i) {
        Scalar by[6], moving[6], rates[6];
        for (int j = 0; j < 6; ++j) by[j] = step[i + j], moving[j] = v[i + j];
        detail::rate_of_screw(by, moving, rates);
        for (int j = 0; j < 6; ++j) rate[i + j] = rates[j];
      },
      [&](auto, auto i) {
        Scalar by[3], moving[3], rates[3];
        for (int j = 0; j < 3; ++j) by[j] = step[i + j], moving[j] = v[i + j];
        detail::rate_of_turn(by, moving, rates);
        for (int j = 0; j < 3; ++j) rate[i + j] = rates[j];
      },
      [](Eigen::Index, Eigen::Index, Eigen::Index) {});
  return rate;
}

}  // namespace dalembert::integrators
