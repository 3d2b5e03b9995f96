// Phase III for a limb that stands alone (width 1): its steps are consecutive slots, and lanes run along them, down a column of
// M and C. See blocks.hpp for the equations.
#pragma once

#include "dalembert/blocks.hpp"

namespace dalembert {

namespace detail {

constexpr int run_lanes = native_lanes < 2 ? 2 : native_lanes;

// Writes value(s) for s in [0, count) to `to`, a register at a time; the last register overlaps the one before where it can.
template <class T, class Value>
DALEMBERT_BLOCK void along(T* to, int count, const Value& value) {
  constexpr int w = run_lanes;
  int s = 0;
  for (; s + w <= count; s += w) store<w, T>(to + s, value(s));
  if (s == count) return;
  if (count >= w) {
    store<w, T>(to + count - w, value(count - w));
    return;
  }
  const Lanes<T, w> x = value(s);
  for (int i = 0; s + i < count; ++i) to[s + i] = x[i];
}

// Σ_j a[j] · b[j][s…], the vectors b taken along slots.
template <class T, int n>
DALEMBERT_INLINE Lanes<T, run_lanes> dot_along(const T (&a)[n], const T* b, int stride, int s) {
  Lanes<T, run_lanes> sum = a[0] * load<run_lanes, T>(b + s);
  for (int j = 1; j < n; ++j) sum += a[j] * load<run_lanes, T>(b + j * stride + s);
  return sum;
}

template <int n, class T>
DALEMBERT_BLOCK void take(T (&to)[n], const T* from, int stride) {
  for (int j = 0; j < n; ++j) to[j] = from[j * stride];
}

// Column k of the lower limb over `rows` joints above it that stand in consecutive slots: M_ik and C_ik.
template <Elements elements, class T>
DALEMBERT_BLOCK void column_above(const Panels<T>& p, int k, const Upper<T>& up, int rows, T* M, T* C) {
  T f[6], g[6];
  if constexpr (has_mass(elements)) {
    take<6, T>(f, p.inertia_force + k, p.stride);
    const T fv[3] = {f[0], f[1], f[2]}, fw[3] = {f[3], f[4], f[5]};
    along<T>(M, rows, [&](int s) DALEMBERT_ALWAYS {
      return dot_along<T, 3>(fv, up.linear, up.stride, s) + dot_along<T, 3>(fw, up.angular, up.stride, s);
    });
  }
  if constexpr (has_coriolis(elements)) {
    take<6, T>(g, p.bias_force + k, p.stride);
    const T gv[3] = {g[0], g[1], g[2]}, gw[3] = {g[3], g[4], g[5]};
    along<T>(C, rows, [&](int s) DALEMBERT_ALWAYS {
      return dot_along<T, 3>(gv, up.linear, up.stride, s) + dot_along<T, 3>(gw, up.angular, up.stride, s);
    });
  }
}

// Column i of the upper limb over `rows` joints below it, from slot `first` on: M_ki and C_ki.
template <Elements elements, class T>
DALEMBERT_BLOCK void column_below(const Panels<T>& p, int first, int rows, const Upper<T>& up, int i, T* M, T* C) {
  T v[3], w[3], d[6];
  take<3, T>(v, up.linear + i, up.stride);
  take<3, T>(w, up.angular + i, up.stride);
  const T *f = p.inertia_force + first, *fw = f + 3 * p.stride, *h = p.transposed + first;
  if constexpr (has_mass(elements))
    along<T>(M, rows,
             [&](int s) DALEMBERT_ALWAYS { return dot_along<T, 3>(v, f, p.stride, s) + dot_along<T, 3>(w, fw, p.stride, s); });
  if constexpr (has_coriolis(elements)) {
    take<6, T>(d, up.rate + i, up.stride);
    along<T>(C, rows,
             [&](int s) DALEMBERT_ALWAYS { return dot_along<T, 6>(d, f, p.stride, s) + dot_along<T, 3>(w, h, p.stride, s); });
  }
}

}  // namespace detail

// The block of the limb with itself; columns [begin, end).
template <Elements elements, class T>
DALEMBERT_BLOCK void run_block(const Panels<T>& p, int first_slot, int first_row, int steps, T* M, T* C, int leading, int begin,
                               int end) {
  const detail::Upper<T> up{p.joint_linear + first_slot, p.joint_angular + first_slot, p.joint_rate + first_slot, p.stride, 1};
  for (int k = begin; k < end; ++k) {
    T *m = M + (first_row + k) * leading + first_row, *c = C + (first_row + k) * leading + first_row;
    detail::column_above<elements, T>(p, first_slot + k, up, k + 1, m, c);
    detail::column_below<elements, T>(p, first_slot + k + 1, steps - k - 1, up, k, m + k + 1, c + k + 1);
  }
}

// The block between the limb and a limb above it, whose steps have slots above_slot[0…]; columns [begin, end) of the limb.
template <Elements elements, int above_steps, class T>
DALEMBERT_BLOCK void run_cross_block(const Panels<T>& p, int first_slot, int first_row, const int* above_slot, int above_row,
                                     T* M, T* C, int leading, int begin, int end) {
  constexpr int stride = padded(above_steps);
  T gathered[12 * stride] = {};
  const T* sources[4] = {p.joint_linear, p.joint_angular, p.joint_rate, p.joint_rate + 3 * p.stride};
  for (int part = 0; part < (has_coriolis(elements) ? 4 : 2); ++part)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < above_steps; ++i) gathered[(3 * part + j) * stride + i] = sources[part][j * p.stride + above_slot[i]];
  const detail::Upper<T> up{gathered, gathered + 3 * stride, gathered + 6 * stride, stride, 1};
  for (int k = begin; k < end; ++k) {
    const int at = (first_row + k) * leading + above_row;
    detail::column_above<elements, T>(p, first_slot + k, up, above_steps, M + at, C + at);
  }
  for (int i = 0; i < above_steps; ++i) {
    const int at = (above_row + i) * leading + first_row + begin;
    detail::column_below<elements, T>(p, first_slot + begin, end - begin, up, i, M + at, C + at);
  }
}

// Rows and columns of a floating base.
template <class T>
DALEMBERT_BLOCK void run_base_columns(const T* force, int stride, int first_slot, int first_row, int steps, T* matrix,
                                      int leading) {
  for (int k = 0; k < steps; ++k)
    for (int j = 0; j < 6; ++j) matrix[(first_row + k) * leading + j] = force[j * stride + first_slot + k];
}
template <class T>
DALEMBERT_BLOCK void run_base_rows(const T* force, int stride, int first_slot, int first_row, int steps, T* matrix,
                                   int leading) {
  for (int j = 0; j < 6; ++j)
    for (int k = 0; k < steps; ++k) matrix[j * leading + first_row + k] = force[j * stride + first_slot + k];
}

}  // namespace dalembert
