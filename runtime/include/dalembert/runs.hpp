// Phase III for a limb that stands alone (width 1): its steps are consecutive slots, and lanes run along them, down a column of
// M and C. See blocks.hpp for the equations.
#pragma once

#include "dalembert/blocks.hpp"

namespace dalembert {

namespace detail {

// A run of a few rows takes registers of four at most: the rest of a wider one would be computed and thrown away.
constexpr int run_lanes = short_lanes < 2 ? 2 : short_lanes;

// Writes value(w, s) for s in [0, count) to `to`, w of them at a time; the last register overlaps the one before where it can.
template <int w, class T, class Value>
DALEMBERT_BLOCK void along_lanes(T* to, int count, const Value& value) {
  constexpr std::integral_constant<int, w> at_once{};
  int s = 0;
  for (; s + w <= count; s += w) store<w, T>(to + s, value(at_once, s));
  if (s == count) return;
  if (count >= w) {
    store<w, T>(to + count - w, value(at_once, count - w));
    return;
  }
  store_some<w, T>(to + s, value(at_once, s), count - s);
}
template <class T, class Value>
DALEMBERT_BLOCK void along(T* to, int count, const Value& value) {
  if constexpr (native_lanes > run_lanes)
    if (count >= native_lanes) return along_lanes<native_lanes>(to, count, value);
  along_lanes<run_lanes>(to, count, value);
}

// The rows from `row` on of one column of a matrix.
template <class T, class Value>
DALEMBERT_BLOCK void put_along(T* matrix, int leading, int column, int row, int count, const Value& value) {
  along<T>(matrix + column * leading + row, count, value);
}

// Where joints are driven by others: run by run of those that are not.
template <class T, class Value>
DALEMBERT_BLOCK void put_along(const Reduced<T>& matrix, int leading, int column, int row, int count, const Value& value) {
  if (matrix.coordinate[column] < 0) {
    along<T>(matrix.driven_column(column) + row, count, value);
    return;
  }
  T* const to = matrix.matrix + matrix.coordinate[column] * leading;
  for (int s = 0; s < count;) {
    if (matrix.coordinate[row + s] < 0) {
      matrix.driven_row(row + s)[column] = value(std::integral_constant<int, run_lanes>{}, s)[0];
      ++s;
      continue;
    }
    int end = s + 1;
    while (end < count && matrix.coordinate[row + end] >= 0) ++end;
    along<T>(to + matrix.coordinate[row + s], end - s, [&](auto w, int i) DALEMBERT_IN_BLOCK { return value(w, s + i); });
    s = end;
  }
}

// Σ_j a[j] · b[j][s…], the vectors b taken along slots.
template <int w, class T>
DALEMBERT_INLINE Lanes<T, w> dot_along(const T (&a)[3], const T* b, int stride, int s) {
  return a[0] * load<w, T>(b + s) + a[1] * load<w, T>(b + stride + s) + a[2] * load<w, T>(b + 2 * stride + s);
}

// Three components at one slot of every factor.
template <class T, int n>
struct Single {
  T at[n][3];

  Single(const T* const (&factors)[n], int stride, int slot) {
    for (int f = 0; f < n; ++f)
      for (int j = 0; j < 3; ++j) at[f][j] = factors[f][j * stride + slot];
  }
};

// Column k of the lower limb: the sum of terms with the lower factors of one joint, along the joints above.
template <int w, class T, int nl, int nu, int lower, int upper>
DALEMBERT_INLINE Lanes<T, w> along_above(const Single<T, nl>& k, const Joints<T, nu>& up, int s, Sum<Term<lower, upper>>) {
  return dot_along<w, T>(k.at[lower], up.at[upper], up.stride, s);
}
template <int w, class T, int nl, int nu, int lower, int upper, class Next, class... Rest>
DALEMBERT_INLINE Lanes<T, w> along_above(const Single<T, nl>& k, const Joints<T, nu>& up, int s,
                                         Sum<Term<lower, upper>, Next, Rest...>) {
  return dot_along<w, T>(k.at[lower], up.at[upper], up.stride, s) + along_above<w>(k, up, s, Sum<Next, Rest...>{});
}

// Column i of the upper limb: the sum of terms with the upper factors of one joint, along the joints below.
template <int w, class T, int nl, int nu, int lower, int upper>
DALEMBERT_INLINE Lanes<T, w> along_below(const Single<T, nu>& i, const Factors<T, nl>& p, int s, Sum<Term<lower, upper>>) {
  return dot_along<w, T>(i.at[upper], p.at[lower], p.stride, s);
}
template <int w, class T, int nl, int nu, int lower, int upper, class Next, class... Rest>
DALEMBERT_INLINE Lanes<T, w> along_below(const Single<T, nu>& i, const Factors<T, nl>& p, int s,
                                         Sum<Term<lower, upper>, Next, Rest...>) {
  return dot_along<w, T>(i.at[upper], p.at[lower], p.stride, s) + along_below<w>(i, p, s, Sum<Next, Rest...>{});
}

template <class T, int n>
DALEMBERT_BLOCK Factors<T, n> moved(Factors<T, n> p, int slots) {
  for (int f = 0; f < n; ++f) p.at[f] += slots;
  return p;
}

template <class AboveSum>
AboveSum below_of(Symmetric<AboveSum>);
template <class AboveSum, class BelowSum>
BelowSum below_of(Square<AboveSum, BelowSum>);

// Column k of the lower limb over `rows` joints above it that stand in consecutive slots.
template <class T, int nl, int nu, class To, class... Kinds>
DALEMBERT_BLOCK void column_above(Matrices<Kinds...>, const Factors<T, nl>& p, int k, const Joints<T, nu>& up, int rows,
                                  const To* matrices, int leading, int column, int row) {
  const Single<T, nl> single(p.at, p.stride, k);
  int m = 0;
  (void)std::initializer_list<int>{(
      put_along(matrices[m++], leading, column, row, rows,
                [&](auto w, int s) DALEMBERT_IN_BLOCK { return along_above<w.value>(single, up, s, typename Kinds::Above{}); }),
      0)...};
}

// Column i of the upper limb over `rows` joints below it, from slot `first` on.
template <class T, int nl, int nu, class To, class... Kinds>
DALEMBERT_BLOCK void column_below(Matrices<Kinds...>, const Factors<T, nl>& p, int first, int rows, const Joints<T, nu>& up,
                                  int i, const To* matrices, int leading, int column, int row) {
  const Single<T, nu> single(up.at, up.stride, i * up.step);
  const Factors<T, nl> from = moved(p, first);
  int m = 0;
  (void)std::initializer_list<int>{(put_along(matrices[m++], leading, column, row, rows,
                                              [&](auto w, int s) DALEMBERT_IN_BLOCK {
                                                return along_below<w.value>(single, from, s, decltype(below_of(Kinds{})){});
                                              }),
                                    0)...};
}

}  // namespace detail

// The block of the limb with itself; columns [begin, end).
template <class Kinds, class T, int nl, int nu, class To>
DALEMBERT_BLOCK void run_block(const Factors<T, nl>& lower, const Factors<T, nu>& upper, int first_slot, int first_row,
                               int steps, const To* matrices, int leading, int begin, int end) {
  const detail::Joints<T, nu> up = detail::joints_of(upper, first_slot, 1);
  for (int k = begin; k < end; ++k) {
    const int column = first_row + k;
    detail::column_above<T>(Kinds{}, lower, first_slot + k, up, k + 1, matrices, leading, column, first_row);
    detail::column_below<T>(Kinds{}, lower, first_slot + k + 1, steps - k - 1, up, k, matrices, leading, column, column + 1);
  }
}

// The block between the limb and a limb above it, whose steps have slots above_slot[0…]; columns [begin, end) of the limb.
template <class Kinds, int above_steps, class T, int nl, int nu, class To>
DALEMBERT_BLOCK void run_cross_block(const Factors<T, nl>& lower, const Factors<T, nu>& upper, int first_slot, int first_row,
                                     const int* above_slot, int above_row, const To* matrices, int leading, int begin,
                                     int end) {
  constexpr int stride = padded(above_steps);
  T gathered[3 * nu * stride + detail::run_lanes] = {};  // between driven joints a register is read from any of them on
  detail::Joints<T, nu> up{{}, stride, 1};
  for (int f = 0; f < nu; ++f) {
    up.at[f] = gathered + 3 * f * stride;
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < above_steps; ++i) gathered[(3 * f + j) * stride + i] = upper.at[f][j * upper.stride + above_slot[i]];
  }
  for (int k = begin; k < end; ++k)
    detail::column_above<T>(Kinds{}, lower, first_slot + k, up, above_steps, matrices, leading, first_row + k, above_row);
  for (int i = 0; i < above_steps; ++i)
    detail::column_below<T>(Kinds{}, lower, first_slot + begin, end - begin, up, i, matrices, leading, above_row + i,
                            first_row + begin);
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
template <class T>
DALEMBERT_BLOCK void run_base_columns(const T* force, int stride, int first_slot, int first_row, int steps,
                                      const Reduced<T>& matrix, int leading) {
  for (int k = 0; k < steps; ++k)
    for (int j = 0; j < 6; ++j) *matrix.at(j, first_row + k, leading) = force[j * stride + first_slot + k];
}
template <class T>
DALEMBERT_BLOCK void run_base_rows(const T* force, int stride, int first_slot, int first_row, int steps,
                                   const Reduced<T>& matrix, int leading) {
  for (int j = 0; j < 6; ++j)
    for (int k = 0; k < steps; ++k) *matrix.at(first_row + k, j, leading) = force[j * stride + first_slot + k];
}

}  // namespace dalembert
