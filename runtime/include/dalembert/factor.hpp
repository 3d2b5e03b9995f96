// Mass matrices factored along the tree, M = L' D L (Featherstone 2008, section 6.5): what is made of the factors.
//
// Coordinates are numbered depth first: `above` has the coordinate above each (-1: none). They are taken a chain at a time:
// up to longest_chain of them, each but the first directly below the one before it and alone there. Matrices are n x n, column
// by column.
#pragma once

#include <dalembert/chain_shapes.hpp>
#include <dalembert/columns.hpp>
#include <dalembert/pivots.hpp>
#include <type_traits>

namespace dalembert {

// The coordinates above a chain, the nearest first.
struct CoordinatesAbove {
  const int* coordinates;
  int count;
};

// Eights of elements that a product of matrices takes at a time, for two of its columns: as many as registers hold.
inline constexpr int product_eights = native_lanes < 8 ? 2 : 4;

namespace detail {

// f(how many lanes, from where on) over `count` elements, whole registers first.
template <int count, class F>
static DALEMBERT_INLINE void each_piece(const F& f) {
  constexpr int w = least(native_lanes, 4), whole = count / w * w;
  for_constants<count / w>([&](auto i) DALEMBERT_IN_BLOCK {
    f(std::integral_constant<int, w>{}, std::integral_constant<int, decltype(i)::value * w>{});
  });
  if constexpr (w == 4 && (count & 2) != 0) f(std::integral_constant<int, 2>{}, std::integral_constant<int, whole>{});
  if constexpr (w > 1 && (count & 1) != 0) f(std::integral_constant<int, 1>{}, std::integral_constant<int, count - 1>{});
}

// f(k) for each k of `path`, then for those from `first` up to `end`. One loop, so that sums stay in registers.
template <class F>
static DALEMBERT_INLINE void along(const int* path, int count, int first, int end, const F& f) {
  DALEMBERT_KEEP_LOOP
  for (int i = 0; i < count + end - first; ++i) f(i < count ? path[i] : first + i - count);
}

// Rows of (L' D L)^-1 of a chain from `first` on, before the chain: rows `begin` to `begin + rows` of it, of `eights` times
// eight columns from i on. Each is minus the sum over k above it of L's element times row k.
template <int n, int eights, int begin, int rows, class T>
static DALEMBERT_INLINE void negative_sums(const int* path, int count, int first, const T* factor, T* inverse, int i) {
  constexpr int w = native_lanes, pieces = eights * 8 / w, stride = inverse_stride(n);
  const T* const factors = factor + (first + begin) * n;
  Lanes<T, w> sum[rows][pieces]{};
  along(path, count, first, first + begin, [&](int k) DALEMBERT_IN_BLOCK {
    const T* const row = inverse + k * stride + i;
    Lanes<T, w> x[pieces];
    for_constants<pieces>([&](auto p) DALEMBERT_IN_BLOCK {
      x[p] = load<w>(row + w * p);
      keep_in_register<T>(x[p]);
    });
    for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
      const Lanes<T, w> times = broadcast<w, T>(factors[r * n + k]);
      for_constants<pieces>([&](auto p) DALEMBERT_IN_BLOCK { sum[r][p] -= times * x[p]; });
    });
  });
  for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
    for_constants<decltype(r)::value>([&](auto k) DALEMBERT_IN_BLOCK {
      const Lanes<T, w> times = broadcast<w, T>(factors[r * n + first + begin + k]);
      for_constants<pieces>([&](auto p) DALEMBERT_IN_BLOCK { sum[r][p] -= times * sum[k][p]; });
    });
    for_constants<pieces>(
        [&](auto p) DALEMBERT_IN_BLOCK { store<w, T>(inverse + (first + begin + r) * stride + i + w * p, sum[r][p]); });
  });
}

// All m rows of the chain, as many at a time as registers hold.
template <int n, int m, int eights, class T, int begin = 0>
static DALEMBERT_INLINE void negative_chain_sums(const int* path, int count, int first, const T* factor, T* inverse, int i) {
  constexpr int registers = native_lanes < 4 ? 8 : 3 * native_lanes,
                rows = least(m - begin, registers * native_lanes / (8 * eights));
  negative_sums<n, eights, begin, rows, T>(path, count, first, factor, inverse, i);
  if constexpr (begin + rows < m) negative_chain_sums<n, m, eights, T, begin + rows>(path, count, first, factor, inverse, i);
}

// Of a column of n numbers, those from `begin` on: the last lanes may reach beyond its end.
template <int n, int w, class T>
static DALEMBERT_INLINE Lanes<T, w> load_piece(const T* column, int begin) {
  constexpr int rest = n % w;
  if constexpr (rest > 0)
    if (begin + w > n) return load_first<rest, w, T>(column + begin);
  return load<w>(column + begin);
}
template <int n, int w, class T>
static DALEMBERT_INLINE void store_piece(T* column, int begin, const Lanes<T, w>& x) {
  constexpr int rest = n % w;
  if (begin + w <= n) {
    store<w, T>(column + begin, x);
  } else if (rest > 0 && begin < n) {
    store_first<rest, w, T>(column + begin, x);
  }
}

}  // namespace detail

// Rows of (L' D L)^-1 of the m coordinates of a chain from `first` on, and the columns that mirror them, as far as they lie
// before the chain.
template <int n, int m, class T>
__attribute__((noinline)) static void invert_before_chain(int first, const int* path, int count, const T* factor,
                                                          T* inverse) noexcept {
  constexpr int stride = inverse_stride(n), most = native_lanes < 8 ? 1 : 4;
  int column = 0;
  for (; column + 8 * (most - 1) < first; column += 8 * most)
    detail::negative_chain_sums<n, m, most, T>(path, count, first, factor, inverse, column);
  detail::for_constants<most - 1>([&](auto fewer) DALEMBERT_IN_BLOCK {
    constexpr int eights = most - 1 - decltype(fewer)::value;
    if (column < first && column + 8 * (eights - 1) < first) {
      detail::negative_chain_sums<n, m, eights, T>(path, count, first, factor, inverse, column);
      column += 8 * eights;
    }
  });
  for (int j = 0; j < first; j += 4)
    for (int r = first; r < first + m; r += 4) {
      Lanes<T, 4> rows[4], turned[4];
      for (int i = 0; i < 4; ++i) rows[i] = load<4>(inverse + (r + i) * stride + j);
      detail::transpose<T>(rows, turned);
      for (int i = 0; i < 4; ++i) store<4, T>(inverse + (j + i) * stride + r, turned[i]);
    }
}

// Rows and columns of X = (L' D L)^-1, those of the chain of m coordinates from `first` on. inverse: inverse_size(n) elements,
// inverse_stride(n) to a column, zero at first; what stands before the chain must be there already. factor: L', of which the
// elements above the diagonal are read.
//
// Up to the diagonal, row i of X is that of D^-1 L^-T less the sum over k above i of L_ik X_k: no inverse of L is needed but
// each chain's own.
template <int n, int m, class T>
__attribute__((noinline)) static void invert_chain(int first, CoordinatesAbove above, const T* factor, const T* pivots,
                                                   T* inverse) noexcept {
  constexpr int w = m <= 4 && native_lanes > 4 ? 4 : native_lanes, pieces = ((m <= 4 ? 4 : 8) + w - 1) / w;
  constexpr int stride = inverse_stride(n);
  const int *const path = above.coordinates, count = above.count;
  if (first > 0) invert_before_chain<n, m>(first, path, count, factor, inverse);
  // Between the chain's own, lanes over its rows. At first columns of its L^-1, from the last, since
  // L^-1 e_k = e_k - the sum over j beyond k of L_jk L^-1 e_j.
  Lanes<T, w> row[m][pieces];
  const auto subtract = [&](auto r, T times, auto k) DALEMBERT_IN_BLOCK {
    detail::for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { row[r][i] -= broadcast<w, T>(times) * row[k][i]; });
  };
  detail::for_constants<m>([&](auto step) DALEMBERT_IN_BLOCK {
    constexpr int k = m - 1 - decltype(step)::value;
    detail::for_constants<pieces>(
        [&](auto i) DALEMBERT_IN_BLOCK { row[k][i] = each_lane<w, T>([=](int lane) { return T(i * w + lane == k); }); });
    detail::for_constants<m - 1 - k>([&](auto back) DALEMBERT_IN_BLOCK {
      constexpr int j = m - 1 - decltype(back)::value;
      subtract(std::integral_constant<int, k>{}, factor[(first + j) * n + first + k], std::integral_constant<int, j>{});
    });
  });
  detail::for_constants<m>([&](auto r) DALEMBERT_IN_BLOCK {
    const T reciprocal = T(1) / pivots[first + r];
    detail::for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { row[r][i] *= broadcast<w, T>(reciprocal); });
  });
  for (int k = 0; k < count; ++k)
    detail::for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      const Lanes<T, w> x = load<w>(inverse + path[k] * stride + first + i * w);
      detail::for_constants<m>([&](auto r)
                                   DALEMBERT_IN_BLOCK { row[r][i] -= broadcast<w, T>(factor[(first + r) * n + path[k]]) * x; });
    });
  detail::for_constants<m>([&](auto r) DALEMBERT_IN_BLOCK {
    detail::for_constants<decltype(r)::value>([&](auto k)
                                                  DALEMBERT_IN_BLOCK { subtract(r, factor[(first + r) * n + first + k], k); });
    detail::for_constants<pieces>(
        [&](auto i) DALEMBERT_IN_BLOCK { store<w, T>(inverse + (first + r) * stride + first + i * w, row[r][i]); });
  });
}

// `inverse` of invert_chain() without the padding.
template <int n, class T>
DALEMBERT_BLOCK void without_padding(const T* inverse, T* result) noexcept {
  constexpr int w = native_lanes;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; i += w) detail::store_piece<n, w>(result + j * n, i, load<w>(inverse + j * inverse_stride(n) + i));
}

namespace detail {

// `columns` columns of -a b, `eights` times eight elements of each from `begin` on.
template <int n, int columns, int eights, class T>
static DALEMBERT_INLINE void negative_product_tile(const int* path, int count, int first, int last, const T* a, const T* b,
                                                   T* result, int begin) {
  constexpr int w = native_lanes, pieces = eights * 8 / w;
  Lanes<T, w> sum[columns][pieces]{};
  along(path, count, first, last + 1, [&](int k) DALEMBERT_IN_BLOCK {
    const T* column = a + k * inverse_stride(n) + begin;
    Lanes<T, w> factor[columns];
    for_constants<columns>([&](auto j) DALEMBERT_IN_BLOCK { factor[j] = broadcast<w, T>(b[j * n + k]); });
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      Lanes<T, w> x = load<w>(column + w * i);
      keep_in_register<T>(x);
      for_constants<columns>([&](auto j) DALEMBERT_IN_BLOCK { sum[j][i] -= factor[j] * x; });
    });
  });
  for_constants<columns>([&](auto j) DALEMBERT_IN_BLOCK {
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { store_piece<n, w>(result + j * n, begin + w * i, sum[j][i]); });
  });
}

template <int n, int columns, class T>
static DALEMBERT_INLINE void negative_product_columns(const int* path, int count, int first, int last, const T* a, const T* b,
                                                      T* result) {
  constexpr int eights = (n + 7) / 8, some = eights % product_eights;
  for (int i = 0; i + product_eights <= eights; i += product_eights)
    negative_product_tile<n, columns, product_eights, T>(path, count, first, last, a, b, result, 8 * i);
  if constexpr (some > 0)
    negative_product_tile<n, columns, some, T>(path, count, first, last, a, b, result, 8 * (eights - some));
}

}  // namespace detail

// Columns of result = -a b: those of a chain, from `first` up to `end`. last: the last coordinate beyond the chain. a: as
// invert_chain() leaves it; b is zero where neither of two coordinates is above the other.
template <int n, class T>
__attribute__((noinline)) static void negative_product_chain(int first, int end, int last, CoordinatesAbove above, const T* a,
                                                             const T* b, T* result) noexcept {
  const int *const path = above.coordinates, count = above.count;
  int j = first;
  for (; j + 2 <= end; j += 2)
    detail::negative_product_columns<n, 2, T>(path, count, first, last, a, b + j * n, result + j * n);
  if (j < end) detail::negative_product_columns<n, 1, T>(path, count, first, last, a, b + j * n, result + j * n);
}

}  // namespace dalembert
