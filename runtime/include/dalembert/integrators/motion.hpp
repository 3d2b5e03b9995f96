// Where a motion leads: positions plus twists, the floating base's pose on its group.
//
// q and v as everywhere: on a floating base q has one entry more than v, begins with the base's position in the world and its
// quaternion x y z w, and v begins with the base's twist in its own axes; on a fixed base both are the joints'. All sizes may
// be fixed at compile time, and nothing allocates then.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <dalembert/spatial.hpp>

namespace dalembert::integrators {

// Whether the base floats; and whether it may, as far as sizes fixed at compile time tell.
template <class Q, class V>
bool floats(const Q& q, const V& v) {
  return q.size() != v.size();
}
template <class Q, class V>
inline constexpr bool may_float = Q::RowsAtCompileTime == Eigen::Dynamic || Q::RowsAtCompileTime != V::RowsAtCompileTime;

namespace detail {

// (1 − cos a) / a² and (a − sin a) / a³ of an angle a, given by its square; their series where the quotients cancel.
template <class Scalar>
void exponential_coefficients(Scalar squared, Scalar& first, Scalar& second) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  if (squared < Scalar(1e-3)) {  // what is left out is below 1e-17
    first = Scalar(0.5) - squared / 24 * (1 - squared / 30 * (1 - squared / 56 * (1 - squared / 90)));
    second = Scalar(1) / 6 - squared / 120 * (1 - squared / 42 * (1 - squared / 72 * (1 - squared / 110)));
  } else {
    const Scalar angle = sqrt(squared);
    first = (1 - cos(angle)) / squared;
    second = (angle - sin(angle)) / (squared * angle);
  }
}

// sin(a/2) / a and cos(a/2).
template <class Scalar>
void half_angle(Scalar squared, Scalar& sine, Scalar& cosine) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  const Scalar angle = sqrt(squared);
  cosine = cos(angle / 2);
  sine = squared < Scalar(1e-8) ? Scalar(0.5) - squared / 48 : sin(angle / 2) / angle;
}

// The base's seven entries of q, moved by the first six of `step`; written over those of `next`.
template <class Q, class V>
void move_base(const Q& q, const V& step, Q& next) {
  using Scalar = typename Q::Scalar;
  const Vector3<Scalar> slide = step.template head<3>(), turn = step.template segment<3>(3);
  const Scalar squared = turn.squaredNorm();
  Scalar first, second, sine, cosine;
  exponential_coefficients(squared, first, second);
  half_angle(squared, sine, cosine);
  const Vector3<Scalar> across = turn.cross(slide);
  const Vector3<Scalar> along = slide + first * across + second * turn.cross(across);
  const Scalar x = q[3], y = q[4], z = q[5], w = q[6];
  next.template head<3>() = q.template head<3>() + rotation_of_quaternion<Scalar>(x, y, z, w) * along;
  const Scalar a = sine * turn[0], b = sine * turn[1], c = sine * turn[2], d = cosine;
  Eigen::Matrix<Scalar, 4, 1> turned(w * a + x * d + y * c - z * b, w * b - x * c + y * d + z * a,
                                     w * c + x * b - y * a + z * d, w * d - x * a - y * b - z * c);
  turned *= (3 - turned.squaredNorm()) / 2;
  next.template segment<4>(3) = turned;
}

// The first six of `step`, such that move_base(from, step) is the base of `to`.
template <class Q, class V>
void base_difference(const Q& from, const Q& to, V& step) {
  using std::atan2;
  using std::cos;
  using std::sin;
  using std::sqrt;
  using Scalar = typename Q::Scalar;
  const Scalar x = from[3], y = from[4], z = from[5], w = from[6], a = to[3], b = to[4], c = to[5], d = to[6];
  Eigen::Matrix<Scalar, 4, 1> turned(w * a - x * d - y * c + z * b, w * b + x * c - y * d - z * a,
                                     w * c - x * b + y * a - z * d, w * d + x * a + y * b + z * c);
  if (turned[3] < 0) turned = -turned;  // of the two ways round the shorter
  const Scalar half_sine = turned.template head<3>().norm(), angle = 2 * atan2(half_sine, turned[3]);
  // angle / sin(angle/2), and (1 − angle/2 · cot(angle/2)) / angle², or their series.
  const Scalar ratio = half_sine < Scalar(1e-6) ? 2 + half_sine * half_sine / 3 : angle / half_sine;
  const Vector3<Scalar> turn = ratio * turned.template head<3>();
  const Scalar squared = angle * angle;
  const Scalar second = squared < Scalar(1e-2) ? (1 + squared / 60 * (1 + squared / 42 * (1 + squared / 40))) / 12
                                               : (1 - angle / 2 * cos(angle / 2) / sin(angle / 2)) / squared;
  const Vector3<Scalar> apart =
      rotation_of_quaternion<Scalar>(x, y, z, w).transpose() * (to.template head<3>() - from.template head<3>());
  const Vector3<Scalar> across = turn.cross(apart);
  step.template head<3>() = apart - across / 2 + second * turn.cross(across);
  step.template segment<3>(3) = turn;
}

}  // namespace detail

// q, moved by the twist `step` (m, rad: velocity times time, in the base's own axes): next = q · exp(step). The base turns and
// slides along a screw; joints add. The quaternion's length returns to 1 to first order, so that rounding never adds up.
// q and next may be the same; otherwise next has q's size.
template <class Q, class V>
void move(const Q& q, const V& step, Q& next) {
  Eigen::Index joints = step.size();
  if constexpr (may_float<Q, V>)
    if (floats(q, step)) {
      detail::move_base(q, step, next);
      joints -= 6;
    }
  next.tail(joints) = q.tail(joints) + step.tail(joints);
}

// The step that leads from one q to another: to = from · exp(step), with the base turned by at most half a turn; joints
// subtract. The quaternions are of unit length; `step` has v's size.
template <class Q, class V>
void difference(const Q& from, const Q& to, V& step) {
  Eigen::Index joints = step.size();
  if constexpr (may_float<Q, V>)
    if (floats(from, step)) {
      detail::base_difference(from, to, step);
      joints -= 6;
    }
  step.tail(joints) = to.tail(joints) - from.tail(joints);
}

// The rate of `step` when q · exp(step) moves with v: dexp⁻¹ of −step, applied to v, to third order in the step, which is what
// a method of fourth order needs (Munthe-Kaas, BIT 38, 1998; Hairer, Lubich, Wanner, Geometric Numerical Integration, IV.8).
template <class Q, class V>
V rate_of_step(const Q& q, const V& step, const V& v) {
  V rate = v;
  if constexpr (may_float<Q, V>)
    if (floats(q, v)) {
      using Scalar = typename V::Scalar;
      const Matrix6<Scalar> bracket = ad<Scalar>(Vector6<Scalar>(step.template head<6>()));
      const Vector6<Scalar> once = bracket * v.template head<6>();
      rate.template head<6>() += once / 2 + bracket * once / 12;
    }
  return rate;
}

}  // namespace dalembert::integrators
