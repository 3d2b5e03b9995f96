// A pose moved by a twist, on numbers alone: what motion.hpp does of Eigen's vectors and rollout.hpp of lanes.
//
// A pose is seven numbers: place in the world (m), quaternion x y z w. A twist is six, in the pose's own axes, linear first (m,
// rad: velocity times time). All of it has internal linkage: files
// that are compiled for different processors must not share one.
#pragma once

#include <cmath>

namespace dalembert::integrators::detail {

// Of an angle a: (1 − cos a) / a² and (a − sin a) / a³, sin(a/2) / a and cos(a/2).
template <class T>
struct Screw {
  T first, second, sine, cosine;
};

// Below this square series say what they are, whose rest is below 1e-19; quotients would cancel. Of the first two a and a²
// times them are what counts: no more of these is lost than the last digit.
constexpr double small_square = 0.1;

// By the angle's square. T: a number of type S, or lanes of such.
template <class S, class T>
static inline void screw_of_small(const T& squared, Screw<T>& screw) {
  const auto less = [&](double part, const T& rest) { return S(1) - squared * (S(1) / S(part)) * rest; };
  const T one = squared * S(0) + S(1);
  screw.first = S(0.5) * less(12, less(30, less(56, less(90, less(132, less(182, one))))));
  screw.second = S(1) / S(6) * less(20, less(42, less(72, less(110, less(156, less(210, one))))));
  screw.sine = S(0.5) * less(24, less(80, less(168, less(288, less(440, less(624, one))))));
  screw.cosine = less(8, less(48, less(120, less(224, less(360, less(528, one))))));
}
template <class T>
static inline void screw_of_large(const T& squared, Screw<T>& screw) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  const T angle = sqrt(squared), half = sin(angle / 2);
  screw.first = 2 * half * half / squared;
  screw.second = (angle - sin(angle)) / (squared * angle);
  screw.sine = half / angle;
  screw.cosine = cos(angle / 2);
}
template <class T>
static inline void screw_of(const T& squared, Screw<T>& screw) {
  if (squared < T(small_square)) screw_of_small<T>(squared, screw);
  else screw_of_large(squared, screw);
}

template <class T>
static inline T square(const T* a) {
  return a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
}

template <class T>
static inline void cross(const T* a, const T* b, T* to) {
  to[0] = a[1] * b[2] - a[2] * b[1];
  to[1] = a[2] * b[0] - a[0] * b[2];
  to[2] = a[0] * b[1] - a[1] * b[0];
}

// A unit quaternion, turned by three angles along its own axes, `screw` being of their square. Its length returns to 1 to first
// order.
template <class T>
static inline void turn_quaternion(const T* q, const T* step, const Screw<T>& screw, T* next) {
  const T x = q[0], y = q[1], z = q[2], w = q[3], a = screw.sine * step[0], b = screw.sine * step[1], c = screw.sine * step[2],
          d = screw.cosine;
  const T turned[4] = {w * a + x * d + y * c - z * b, w * b - x * c + y * d + z * a, w * c + x * b - y * a + z * d,
                       w * d - x * a - y * b - z * c};
  const T squared = turned[0] * turned[0] + turned[1] * turned[1] + turned[2] * turned[2] + turned[3] * turned[3];
  for (int i = 0; i < 4; ++i) next[i] = turned[i] * ((3 - squared) / 2);
}

// A pose, moved along and about a screw: next = pose · exp(step).
template <class T>
static inline void move_pose_by(const T* pose, const T* step, const Screw<T>& screw, T* next) {
  const T *const turning = step + 3, *const turned = pose + 3;
  T across[3], twice[3], along[3], once[3], again[3];
  cross(turning, step, across);
  cross(turning, across, twice);
  for (int i = 0; i < 3; ++i) along[i] = step[i] + screw.first * across[i] + screw.second * twice[i];
  // The quaternion's rotation of it.
  cross(turned, along, once);
  for (int i = 0; i < 3; ++i) once[i] += turned[3] * along[i];
  cross(turned, once, again);
  for (int i = 0; i < 3; ++i) next[i] = pose[i] + (along[i] + (again[i] + again[i]));
  turn_quaternion(turned, turning, screw, next + 3);
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
