// Sines and cosines of many angles together.
//
// Error at most 2 ulp for |x| ≤ 1e5 (reduction by three parts of π/2 whose products with the quadrant are exact, then the
// minimax polynomials of fdlibm, S1…S6 and C1…C6, on ±π/4 with the reduction's remainder carried along). Larger angles are
// handed to the standard library one by one: as accurate as that is, slower. Infinities and NaN give NaN. Neither
// allocates nor locks.
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
  constexpr double magic = 6755399441055744.0;       // 1.5·2⁵²: adding it rounds to an integer, kept in the low bits
  constexpr double half_pi_1 = 0x1.921fb54400000p0;  // π/2 in parts of 33, 33 and 53 bits
  constexpr double half_pi_2 = 0x1.0b4611a600000p-34;
  constexpr double half_pi_3 = 0x1.3198a2e037073p-69;
  const V shifted = x * 0x1.45f306dc9c883p-1 + magic;
  const V k = shifted - magic;
  I quadrant;
  std::memcpy(&quadrant, &shifted, sizeof quadrant);

  const V first = x - k * half_pi_1;
  const V second = first - k * half_pi_2;
  const V rest = ((first - second) - k * half_pi_2) - k * half_pi_3;
  const V r = second + rest;
  const V tail = (second - r) + rest;  // r + tail is the reduced angle to far more than 53 bits

  const V z = r * r;
  // clang-format off
  const V s = ((((1.58969099521155010221e-10 * z - 2.50507602534068634195e-08) * z + 2.75573137070700676789e-06) * z -
                1.98412698298579493134e-04) * z + 8.33333333332248946124e-03) * z - 1.66666666666666324348e-01;
  const V c = ((((-1.13596475577881948265e-11 * z + 2.08757232129817482790e-09) * z - 2.75573143513906633035e-07) * z +
                2.48015872894767294178e-05) * z - 1.38888888888741095749e-03) * z + 4.16666666666666019037e-02;
  // clang-format on
  const V sin_r = r + (r * z * s + tail * (1.0 - 0.5 * z));
  const V half = 0.5 * z;
  const V one_minus = 1.0 - half;
  const V cos_r = one_minus + (((1.0 - one_minus) - half) + (z * z * c - r * tail));

  const I odd = -(quadrant & 1);  // all ones in odd quadrants, where sine and cosine change places
  I si, ci;
  std::memcpy(&si, &sin_r, sizeof si);
  std::memcpy(&ci, &cos_r, sizeof ci);
  const I sign_s = (quadrant & 2) << 62, sign_c = ((quadrant + 1) & 2) << 62;
  const I out_s = (((si & ~odd) | (ci & odd))) ^ sign_s;
  const I out_c = (((ci & ~odd) | (si & odd))) ^ sign_c;
  std::memcpy(&sine, &out_s, sizeof sine);
  std::memcpy(&cosine, &out_c, sizeof cosine);
}

template <class T>
__attribute__((noinline, cold)) void sincos_large(const T* angle, T* sine, T* cosine, int n) {
  for (int i = 0; i < n; ++i) {
    const double x = static_cast<double>(angle[i]);
    sine[i] = static_cast<T>(std::sin(x));
    cosine[i] = static_cast<T>(std::cos(x));
  }
}

// Blocks of n angles, each read by read(i), a register at a time.
template <int n, class T, class Read>
DALEMBERT_INLINE void sincos_each(const Read& read, T* sine, T* cosine) {
  constexpr int w = native_lanes < 2 ? 2 : n % native_lanes == 0 ? native_lanes : 4;
  using V = Lanes<double, w>;
  Lanes<std::int64_t, w> large{};
  for (int i = 0; i < n; i += w) {
    V s, c;
    const V x = each_lane<w, double>([&](int j) { return static_cast<double>(read(i + j)); });
    large |= (x > sincos_fast_limit) | (x < -sincos_fast_limit);
    sincos_reduced<w>(x, s, c);
    store<w, T>(sine + i, __builtin_convertvector(s, Lanes<T, w>));
    store<w, T>(cosine + i, __builtin_convertvector(c, Lanes<T, w>));
  }
  std::int64_t any = 0;
  for (int j = 0; j < w; ++j) any |= large[j];
  if (__builtin_expect(any != 0, 0)) {
    T angle[padded(n)];
    for (int i = 0; i < n; ++i) angle[i] = read(i);
    sincos_large(angle, sine, cosine, n);
  }
}

}  // namespace detail

// angle (rad), sine, cosine: arrays of padded(n) elements that do not overlap; angle's padding must hold numbers (zeros).
template <int n, class T>
DALEMBERT_INLINE void sincos(const T* angle, T* sine, T* cosine) {
  detail::sincos_each<n, T>([angle](int i) { return angle[i]; }, sine, cosine);
}

// Of angle[at[0]], …, angle[at[n − 1]]; n is a multiple of four, and sine and cosine have room for padded(n).
template <int n, class T>
DALEMBERT_INLINE void sincos_at(const T* angle, const int* at, T* sine, T* cosine) {
  detail::sincos_each<n, T>([angle, at](int i) { return angle[at[i]]; }, sine, cosine);
}

}  // namespace dalembert
