// Whether M = L' D L may be solved with: what rounding may have left of the pivots D, factored from the last coordinate to the
// first.
//
// D_k is the inertia that coordinate k feels when all beyond it are free. Set k moving at rate 1, and let those beyond follow
// with x_j, row k of L^-T. Then D_k = x' M x, and what is wrong with M's elements by rounding, epsilon sqrt(M_ii M_jj), makes
// an error of D_k of epsilon times the bound e_k = sum of M_jj x_j^2, j from k on (M_kk where nothing beyond follows). It
// counts what earlier pivots have lost: where D_j is small, little makes j move much. M is ok where D_k > 4096 epsilon e_k for
// all k, n / 12 times as much for more than twelve coordinates (in float 512, however many): far from the base, where long arms
// leave small parts, elements of M are off by some hundred ulp, behind long chains by a thousand. With rows and columns of M
// divided by sqrt(M_kk), e_k / D_k is at most 1 over the least eigenvalue: where M so divided has a condition below 1e12, in
// float 1e4, it is ok; of more coordinates where its largest eigenvalue is n / 12 at least, as those of trees and chains are.
// The sum of e_k / D_k is the trace of its inverse. Where joints follow others M_jj is what they feel apart, which is not less
// than M_jj but for a factor below their number, and more where they cancel: so much more is wrong with M's elements.
//
// Bounds cost up to as much as the factors; they are only computed where some D_k / M_kk is below a least ratio. Where none is,
// the product of all M_kk / D_k bounds that trace (the determinant bounds the least eigenvalue of a matrix whose diagonal is
// 1), and what several joints lose with no mass between them are six ratios at most: a body has no more freedom.
#pragma once

#include <cstdint>
#include <dalembert/lanes.hpp>
#include <limits>
#include <type_traits>

namespace dalembert {

// Of a mass matrix M = L' D L, factored from the last coordinate to the first: the first coordinate met whose pivot D is not
// above what rounding may leave of it; it moves no mass, or none of its own.
template <class T>
struct FactorStatus {
  int coordinate = -1;  // index in v; -1: none, M is positive definite
  T pivot = T(0);       // its D, kg or kg m^2; not a number where an input is not

  bool ok() const noexcept { return coordinate < 0; }
};

namespace detail {

template <class T>
using CountOf = std::conditional_t<sizeof(T) == 8, std::int64_t, std::int32_t>;  // as wide as T: in lanes

// Pivots that are a larger part of M's diagonal element need no bound: five such losses are not yet those of all digits (in
// float, three).
template <class T>
constexpr T least_ratio() {
  return sizeof(T) < 8 ? T(1.0 / 64) : T(1.0 / 256);
}

// Of a bound, what rounding may leave. n: M's size.
template <class T>
constexpr T rounding_left(int n) {
  return T(sizeof(T) < 8 ? 512.0 : n <= 12 ? 4096.0 : 4096.0 / 12 * n) * std::numeric_limits<T>::epsilon();
}

// Whether a pivot is above a part of a positive number.
template <class T>
DALEMBERT_INLINE bool exceeds(const T& pivot, const T& whole, const T& part) {
  const bool above = pivot > part * whole, positive = pivot > T(0);
  return above & positive;
}

// The status by bounds, from L' above the diagonal of `factor`, n x n, column by column. above: the coordinate above each, -1:
// none; of elements of others nothing is read. x: room for n numbers.
template <class T>
FactorStatus<T> bounded_status(int n, const int* above, const T* factor, const T* pivots, const T* diagonal, T* x) noexcept {
  for (int k = n - 1; k >= 0; --k) {
    T bound = diagonal[k];
    x[k] = T(1);
    for (int j = k + 1; j < n; ++j) {
      x[j] = T(0);
      for (int i = above[j]; i >= k; i = above[i]) x[j] -= factor[j * n + i] * x[i];
      bound += x[j] * x[j] * diagonal[j];
    }
    if (!exceeds<T>(pivots[k], bound, rounding_left<T>(n))) return {k, pivots[k]};
  }
  return {};
}

// The same for some k at a time, side by side; x_j is zero where j is not beyond k.
template <int n, class T>
__attribute__((noinline)) static FactorStatus<T> bounded_status_by_factor(const int* above, const T* factor, const T* pivots,
                                                                          const T* diagonal) noexcept {
  constexpr int w = native_lanes, registers = w < 4 ? 4 : 8 / w, some = w * registers;
  struct Each {  // of some k
    Lanes<T, w> of[registers] = {};
    DALEMBERT_INLINE void add(T factor, const T* x) {
      for_constants<registers>([&](auto r) DALEMBERT_IN_BLOCK { of[r] += factor * load<w>(x + r * w); });
    }
  };
  T unit[2 * some - 1] = {}, x[n * some], bounds[some];
  unit[some - 1] = T(1);
  written_before_read(x);  // of rows above j, those at `begin` or beyond are read, and stored by then
  int run[n];              // where the coordinates above one begin that follow each other up to it
  for (int j = 0; j < n; ++j) run[j] = j > 0 && above[j] == j - 1 ? run[j - 1] : j;
  for (int last = n - 1; last >= 0; last -= some) {
    const int first = last - some + 1, begin = first > 0 ? first : 0;
    Each bound;
    for (int j = begin; j < n; ++j) {
      const T* const column = factor + j * n;
      Each sum, other;
      if constexpr (n > 1)  // none is above the only one, which g++ does not see and warns of
        for (int i = above[j]; i >= begin; i = above[run[i]]) {
          int from = run[i] > begin ? run[i] : begin;  // upwards: the newest x, which has to be waited for, comes last
          for (; from < i; from += 2) {
            sum.add(column[from], x + from * some);
            other.add(column[from + 1], x + (from + 1) * some);
          }
          if (from == i) sum.add(column[i], x + i * some);
        }
      for_constants<registers>([&](auto r) DALEMBERT_IN_BLOCK {
        Lanes<T, w> own = -(sum.of[r] + other.of[r]);
        if (j <= last) own += load<w>(unit + (last - j) + r * w);
        store<w, T>(x + j * some + r * w, own);
        bound.of[r] += own * own * diagonal[j];
      });
    }
    for_constants<registers>([&](auto r) DALEMBERT_IN_BLOCK { store<w, T>(bounds + r * w, bound.of[r]); });
    for (int k = last; k >= begin; --k)
      if (!exceeds<T>(pivots[k], bounds[k - first], rounding_left<T>(n))) return {k, pivots[k]};
  }
  return {};
}

// Six numbers of a twist or wrench, in registers.
template <class T>
struct Six {
  Lanes<T, 4> four{};
  Lanes<T, 2> two{};

  static DALEMBERT_INLINE Six of(const T* from) { return {load<4>(from), load<2>(from + 4)}; }
  DALEMBERT_INLINE T at(int i) const { return i < 4 ? four[i] : two[i - 4]; }
  DALEMBERT_INLINE void add(const Six& x, T factor) { four += factor * x.four, two += factor * x.two; }
  DALEMBERT_INLINE T dot(const Six& x) const {
    const Lanes<T, 4> a = four * x.four;
    const Lanes<T, 2> b = two * x.two;
    return (a[0] + b[0]) + (a[1] + b[1]) + (a[2] + a[3]);
  }
};

// The same of articulated bodies, from V and J of every coordinate, six numbers each: L_ki = V_k.J_i. With P_k = 1 - J_k V_k'
// the parent's twist becomes the body's while k is free, and bounds add up from the tips: e_k = M_kk + J_k' E_k J_k, E_p +=
// P_k' E_k P_k + M_kk V_k V_k'.
template <int n, class T>
__attribute__((noinline)) static FactorStatus<T> bounded_status_by_gains(const int* above, const T* gain, const T* joint,
                                                                         const T* pivots, const T* diagonal) noexcept {
  Six<T> e[6];  // E_k: of the coordinate that follows k in registers, of others in memory
  T kept[n][36];
  bool keeps[n] = {};
  for (int k = n - 1; k >= 0; --k) {
    if (k + 1 == n || above[k + 1] != k) for_constants<6>([&](auto c) DALEMBERT_IN_BLOCK { e[c] = {}; });
    if (keeps[k]) for_constants<6>([&](auto c) DALEMBERT_IN_BLOCK { e[c].add(Six<T>::of(kept[k] + 6 * c), T(1)); });
    const Six<T> v = Six<T>::of(gain + 6 * k), along = Six<T>::of(joint + 6 * k);
    Six<T> sums[2];
    for_constants<6>([&](auto c) DALEMBERT_IN_BLOCK { sums[c % 2].add(e[c], joint[6 * k + c]); });
    sums[0].add(sums[1], T(1));
    const Six<T>& moved = sums[0];
    const T beyond = along.dot(moved), bound = diagonal[k] + (beyond < T(0) ? T(0) : beyond);
    if (!exceeds<T>(pivots[k], bound, rounding_left<T>(n))) return {k, pivots[k]};
    if (above[k] < 0) continue;
    Six<T> left;
    left.add(v, bound), left.add(moved, T(-1));
    for_constants<6>([&](auto c) DALEMBERT_IN_BLOCK { e[c].add(v, left.at(c)), e[c].add(moved, -gain[6 * k + c]); });
    if (above[k] == k - 1) continue;
    T* const parent = kept[above[k]];
    for_constants<6>([&](auto c) DALEMBERT_IN_BLOCK {
      if (keeps[above[k]]) e[c].add(Six<T>::of(parent + 6 * c), T(1));
      store<4, T>(parent + 6 * c, e[c].four), store<2, T>(parent + 6 * c + 4, e[c].two);
    });
    keeps[above[k]] = true;
  }
  return {};
}

// Whether no pivot needs a bound.
template <int n, class T>
DALEMBERT_INLINE bool all_hold(const T* pivots, const T* diagonal) {
  CountOf<T> count = 0;
  for (int k = 0; k < n; ++k) count += exceeds<T>(pivots[k], diagonal[k], least_ratio<T>()) ? 1 : 0;
  return count == n;
}

}  // namespace detail

// above: the coordinate above each, -1: none. factor: n x n, L' above its diagonal.
template <int n, class T>
static inline FactorStatus<T> factor_status(const int* above, const T* factor, const T* pivots, const T* diagonal) noexcept {
  if (__builtin_expect(detail::all_hold<n>(pivots, diagonal), 1)) return {};
  return detail::bounded_status_by_factor<n>(above, factor, pivots, diagonal);
}

// gain, joint: V and J of articulated bodies, 6 x n.
template <int n, class T>
static inline FactorStatus<T> factor_status_by_gains(const int* above, const T* gain, const T* joint, const T* pivots,
                                                     const T* diagonal) noexcept {
  if (__builtin_expect(detail::all_hold<n>(pivots, diagonal), 1)) return {};
  return detail::bounded_status_by_gains<n>(above, gain, joint, pivots, diagonal);
}

// What limbs leave of joints at their slots. no_joint is 1 at slots without one, 0 at others; joint_slot: of coordinates base,
// base + 1, …. gain, linear, angular: a component after another, `stride` elements apart.
template <class T>
struct JointSlots {
  const T *pivots, *diagonal, *no_joint, *gain, *linear, *angular;
  int stride;
  const int* joint_slot;
};

namespace detail {

template <int n, int base, class T>
__attribute__((noinline)) static FactorStatus<T> bounded_status_of_slots(const JointSlots<T>& slots, const int* above, T* gain,
                                                                         T* joint, T* pivots, T* diagonal) noexcept {
  for (int k = base; k < n; ++k) {
    const int slot = slots.joint_slot[k - base];
    pivots[k] = slots.pivots[slot];
    diagonal[k] = slots.diagonal[slot];
    for (int c = 0; c < 6; ++c) gain[6 * k + c] = slots.gain[c * slots.stride + slot];
    for (int c = 0; c < 3; ++c) joint[6 * k + c] = slots.linear[c * slots.stride + slot];
    for (int c = 0; c < 3; ++c) joint[6 * k + 3 + c] = slots.angular[c * slots.stride + slot];
  }
  return bounded_status_by_gains<n>(above, gain, joint, pivots, diagonal);
}

}  // namespace detail

// The same where only what is of the first `base` coordinates stands in `gain`, `joint`, `pivots` and `diagonal`, and the
// joints' at their slots. Taking it from there costs more than the rest, and is only needed where bounds are.
template <int n, int base, int slots, class T>
static inline FactorStatus<T> factor_status_of_slots(const JointSlots<T>& joints, const int* above, T* gain, T* joint,
                                                     T* pivots, T* diagonal) noexcept {
  detail::CountOf<T> count = 0;
  for (int k = 0; k < base; ++k) count += detail::exceeds<T>(pivots[k], diagonal[k], detail::least_ratio<T>()) ? 1 : 0;
  for (int i = 0; i < slots; ++i)
    count += (detail::exceeds<T>(joints.pivots[i], joints.diagonal[i], detail::least_ratio<T>()) | (joints.no_joint[i] > T(0)))
                 ? 1
                 : 0;
  if (__builtin_expect(count == base + slots, 1)) return {};
  return detail::bounded_status_of_slots<n, base>(joints, above, gain, joint, pivots, diagonal);
}

// What was solved for means nothing unless M is positive definite.
template <int n, class T>
static inline void clear_unless_ok(const FactorStatus<T>& status, T* result) noexcept {
  if (status.ok()) return;
  for (int i = 0; i < n; ++i) result[i] = T(0);
}

}  // namespace dalembert
