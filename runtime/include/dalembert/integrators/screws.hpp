// A pose moved by a twist, on numbers alone: what motion.hpp does of Eigen's vectors and rollout.hpp of lanes.
//
// A pose is seven numbers: place in the world (m), quaternion x y z w. A twist is six, in the pose's own axes, linear first (m,
// rad: velocity times time). All of it has internal linkage: files that are compiled
// for different processors must not share one.
#pragma once

#include <cmath>

namespace dalembert::integrators::detail {

// (1 − cos a) / a² and (a − sin a) / a³ of an angle a, given by its square; their series where the quotients cancel. Of a
// and a² times them, which is what counts, no more is lost than the last digit.
template <class Scalar>
static inline void exponential_coefficients(Scalar squared, Scalar& first, Scalar& second) {
  using std::sin;
  using std::sqrt;
  if (squared < Scalar(0.1)) {  // what is left out is below 1e-17
    first = Scalar(0.5) - squared / 24 * (1 - squared / 30 * (1 - squared / 56 * (1 - squared / 90 * (1 - squared / 132))));
    second =
        Scalar(1) / 6 - squared / 120 * (1 - squared / 42 * (1 - squared / 72 * (1 - squared / 110 * (1 - squared / 156))));
  } else {
    const Scalar angle = sqrt(squared), half = sin(angle / 2);
    first = 2 * half * half / squared;
    second = (angle - sin(angle)) / (squared * angle);
  }
}

// sin(a/2) / a and cos(a/2).
template <class Scalar>
static inline void half_angle(Scalar squared, Scalar& sine, Scalar& cosine) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  const Scalar angle = sqrt(squared);
  cosine = cos(angle / 2);
  sine = squared < Scalar(1e-8) ? Scalar(0.5) - squared / 48 : sin(angle / 2) / angle;
}

template <class T>
static inline void cross(const T* a, const T* b, T* to) {
  to[0] = a[1] * b[2] - a[2] * b[1];
  to[1] = a[2] * b[0] - a[0] * b[2];
  to[2] = a[0] * b[1] - a[1] * b[0];
}

// A unit quaternion, turned by three angles along its own axes. Its length returns to 1 to first order.
template <class T>
static inline void turn_quaternion(const T* q, const T* step, T* next) {
  T sine, d;
  half_angle(T(step[0] * step[0] + step[1] * step[1] + step[2] * step[2]), sine, d);
  const T x = q[0], y = q[1], z = q[2], w = q[3], a = sine * step[0], b = sine * step[1], c = sine * step[2];
  const T turned[4] = {w * a + x * d + y * c - z * b, w * b - x * c + y * d + z * a, w * c + x * b - y * a + z * d,
                       w * d - x * a - y * b - z * c};
  const T squared = turned[0] * turned[0] + turned[1] * turned[1] + turned[2] * turned[2] + turned[3] * turned[3];
  for (int i = 0; i < 4; ++i) next[i] = turned[i] * ((3 - squared) / 2);
}

// A pose, moved along and about a screw: next = pose · exp(step).
template <class T>
static inline void move_pose_by(const T* pose, const T* step, T* next) {
  const T *const turning = step + 3, *const turned = pose + 3;
  T first, second, across[3], twice[3], along[3], once[3], again[3];
  exponential_coefficients(T(turning[0] * turning[0] + turning[1] * turning[1] + turning[2] * turning[2]), first, second);
  cross(turning, step, across);
  cross(turning, across, twice);
  for (int i = 0; i < 3; ++i) along[i] = step[i] + first * across[i] + second * twice[i];
  // The quaternion's rotation of it.
  cross(turned, along, once);
  for (int i = 0; i < 3; ++i) once[i] += turned[3] * along[i];
  cross(turned, once, again);
  for (int i = 0; i < 3; ++i) next[i] = pose[i] + (along[i] + (again[i] + again[i]));
  turn_quaternion(turned, turning, next + 3);
}

// ad(step) u, of twists.
template <class T>
static inline void bracket(const T* step, const T* u, T* to) {
  T sliding[3];
  cross(step + 3, u, to);
  cross(step, u + 3, sliding);
  for (int i = 0; i < 3; ++i) to[i] += sliding[i];
  cross(step + 3, u + 3, to + 3);
}

// The rate of a step whose exponential moves with `v`: dexp⁻¹ of −step, applied to v, to third order in the step. Of three
// angles, and of a twist.
template <class T>
static inline void rate_of_turn(const T* step, const T* v, T* rate) {
  T once[3], twice[3];
  cross(step, v, once);
  cross(step, once, twice);
  for (int i = 0; i < 3; ++i) rate[i] = v[i] + (once[i] / 2 + twice[i] / 12);
}
template <class T>
static inline void rate_of_screw(const T* step, const T* v, T* rate) {
  T once[6], twice[6];
  bracket(step, v, once);
  bracket(step, once, twice);
  for (int i = 0; i < 6; ++i) rate[i] = v[i] + (once[i] / 2 + twice[i] / 12);
}

}  // namespace dalembert::integrators::detail
