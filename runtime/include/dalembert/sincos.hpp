// Sines and cosines of many angles together.
//
// Error at most 2 ulp for |x| ≤ 1e5: reduction by three parts of π/2, then the minimax polynomials of fdlibm, S1…S6 and
// C1…C6, on ±π/4, in as short a chain as they can be. Where larger angles are among them, all are handed to the standard
// library one by one: as accurate as that is, slower. With -DDALEMBERT_LIBRARY_SINES all angles always are, to compare with.
// Infinities and NaN give NaN. Neither allocates nor locks.
#pragma once

#include <cmath>
#include <cstdint>

#include "dalembert/lanes.hpp"

namespace dalembert {

inline constexpr double sincos_fast_limit = 1e5;

namespace detail {

template <int n>
DALEMBERT_INLINE void sincos_reduced(const Lanes<double, n>& x, Lanes<double, n>& sine, Lanes<double, n>& cosine) {
  using V = Lanes<double, n>;
  using I = Lanes<std::int64_t, n>;
  constexpr double magic = 6755399441055744.0;         // 1.5·2⁵²: adding it rounds to an integer, kept in the low bits
  constexpr double half_pi_1 = 0x1.921fb54440000p0;    // π/2 in parts of 37, 37 and 53 bits: products with a quadrant of 16
  constexpr double half_pi_2 = 0x1.68c234c4c0000p-39;  // bits are exact
  constexpr double half_pi_3 = 0x1.98a2e03707345p-77;
  const V shifted = x * 0x1.45f306dc9c883p-1 + magic;
  const V k = shifted - magic;
  I quadrant;
  std::memcpy(&quadrant, &shifted, sizeof quadrant);

  // The first difference is exact. Where the second leaves much, it rounds and the third hardly changes it; where it leaves
  // little, it is exact and the third rounds.
  const V r = ((x - k * half_pi_1) - k * half_pi_2) - k * half_pi_3;
  const V z = r * r, z2 = z * z;
  // clang-format off
  const V s = ((1.58969099521155010221e-10 * z - 2.50507602534068634195e-08) * z2 +
               (2.75573137070700676789e-06 * z - 1.98412698298579493134e-04)) * z2 +
              (8.33333333332248946124e-03 * z - 1.66666666666666324348e-01);
  const V c = ((-1.13596475577881948265e-11 * z + 2.08757232129817482790e-09) * z2 +
               (-2.75573143513906633035e-07 * z + 2.48015872894767294178e-05)) * z2 +
              (-1.38888888888741095749e-03 * z + 4.16666666666666019037e-02);
  // clang-format on
  const V sin_r = r + r * z * s;
  const V cos_r = 1.0 - z * (0.5 - z * c);

  I si, ci;
  std::memcpy(&si, &sin_r, sizeof si);
  std::memcpy(&ci, &cos_r, sizeof ci);
  const I sign_bit = I{} + INT64_MIN;
  const I change = (si ^ ci) & -(quadrant & 1);  // in odd quadrants sine and cosine change places
  const I out_s = si ^ change ^ ((quadrant << 62) & sign_bit);
  const I out_c = ci ^ change ^ (((quadrant + 1) << 62) & sign_bit);
  std::memcpy(&sine, &out_s, sizeof sine);
  std::memcpy(&cosine, &out_c, sizeof cosine);
}

template <class T>
__attribute__((noinline, cold)) static void sincos_large(const T* angle, T* sine, T* cosine, int n) {
  for (int i = 0; i < n; ++i) {
    const double x = static_cast<double>(angle[i]);
    sine[i] = static_cast<T>(std::sin(x));
    cosine[i] = static_cast<T>(std::cos(x));
  }
}

// Blocks of n angles, each read by read(i), a register at a time.
template <int n, class T, class Read>
DALEMBERT_BLOCK void sincos_each(const Read& read, T* sine, T* cosine) {
#ifdef DALEMBERT_LIBRARY_SINES
  T all[padded(n)];
  for (int i = 0; i < n; ++i) all[i] = read(i);
  return sincos_large(all, sine, cosine, n);
#endif
  constexpr int w = native_lanes < 2 ? 2 : n % native_lanes == 0 ? native_lanes : 4;
  using V = Lanes<double, w>;
  V largest{}, smallest{};  // NaN is neither: one that nobody needs changes nothing else
  for (int i = 0; i < n; i += w) {
    V s, c;
    const V x = each_lane<w, double>([&](int j) { return static_cast<double>(read(i + j)); });
    largest = x > largest ? x : largest;
    smallest = x < smallest ? x : smallest;
    sincos_reduced<w>(x, s, c);
    store<w, T>(sine + i, __builtin_convertvector(s, Lanes<T, w>));
    store<w, T>(cosine + i, __builtin_convertvector(c, Lanes<T, w>));
  }
  const V size = largest > -smallest ? largest : -smallest;
  bool small = true;
  for (int j = 0; j < w; ++j) small &= size[j] <= sincos_fast_limit;
  if (__builtin_expect(!small, 0)) {
    T angle[padded(n)];
    for (int i = 0; i < n; ++i) angle[i] = read(i);
    sincos_large(angle, sine, cosine, n);
  }
}

}  // namespace detail

// angle (rad), sine, cosine: arrays of padded(n) elements that do not overlap; angle's padding must hold numbers (zeros).
template <int n, class T>
DALEMBERT_BLOCK void sincos(const T* angle, T* sine, T* cosine) {
  detail::sincos_each<n, T>([angle](int i) { return angle[i]; }, sine, cosine);
}

// Of angle[at[0]], …, angle[at[n − 1]]; n is a multiple of four, and sine and cosine have room for padded(n).
template <int n, class T>
DALEMBERT_BLOCK void sincos_at(const T* angle, const int* at, T* sine, T* cosine) {
  detail::sincos_each<n, T>([angle, at](int i) { return angle[at[i]]; }, sine, cosine);
}

}  // namespace dalembert
