// Mass matrices factored along the tree, M = L' D L (Featherstone 2008, section 6.5): what is made of the factors.
//
// Coordinates are numbered depth first: `above` has the coordinate above each (-1: none), `last` the last one beyond each,
// which may be itself. Matrices are n x n, column by column.
#pragma once

#include <dalembert/lanes.hpp>
#include <limits>

namespace dalembert {

// Of a mass matrix M = L' D L, factored from the last coordinate to the first: the first coordinate met whose pivot D is not
// above what rounding may leave of M's diagonal element, n epsilon M_kk; it moves no mass, or none of its own.
template <class T>
struct FactorStatus {
  int coordinate = -1;  // index in v; -1: none, M is positive definite
  T pivot = T(0);       // its D, kg or kg m^2; not a number where an input is not

  bool ok() const noexcept { return coordinate < 0; }
};

template <int n, class T>
inline FactorStatus<T> factor_status(const T* pivots, const T* diagonal) noexcept {
  FactorStatus<T> status;
  const T rounding = T(n) * std::numeric_limits<T>::epsilon();
  for (int k = 0; k < n; ++k) {
    const bool good = pivots[k] > rounding * diagonal[k] && pivots[k] > T(0);
    status.coordinate = good ? status.coordinate : k;
    status.pivot = good ? status.pivot : pivots[k];
  }
  return status;
}

// What was solved for means nothing unless M is positive definite.
template <int n, class T>
inline void clear_unless_ok(const FactorStatus<T>& status, T* result) noexcept {
  if (status.ok()) return;
  for (int i = 0; i < n; ++i) result[i] = T(0);
}

namespace detail {

// Columns of n numbers go in pieces of this many; where the last piece does not fit it reaches back over the one before.
template <int n>
inline constexpr int piece = n < 4   ? 1
                             : n < 8 ? 4
                                     : 8;

template <int n, class F>
DALEMBERT_INLINE void in_pieces(int begin, int end, const F& f) {
  constexpr int p = piece<n>;
  for (int i = begin; i < end; i += p) f(i + p <= n ? i : n - p);
}

}  // namespace detail

// inverse = L^-1 D^-1 L^-T. factor: L', of which the elements above the diagonal are read. room: n x n, zero but for what an
// earlier call has left there.
template <int n, class T>
DALEMBERT_BLOCK void invert(const int* above, const int* last, const T* factor, const T* pivots, T* room, T* inverse) noexcept {
  constexpr int p = detail::piece<n>;
  // Column k of room: of L^-1, which is not zero from k to the last coordinate beyond it. From the leaves, since
  // L^-1 e_k = e_k - the sum over j beyond k of L_jk L^-1 e_j.
  for (int k = n - 1; k >= 0; --k) {
    T* column = room + k * n;
    detail::in_pieces<n>(k, last[k] + 1, [&](int i) DALEMBERT_IN_BLOCK {
      Lanes<T, p> sum{};
      for (int j = k + 1; j <= last[k] && j < i + p; ++j) sum -= broadcast<p, T>(factor[j * n + k]) * load<p>(room + j * n + i);
      store<p, T>(column + i, sum);
    });
    column[k] = T(1);
  }
  T reciprocal[n];
  for (int k = 0; k < n; ++k) reciprocal[k] = T(1) / pivots[k];
  for (int j = 0; j < n; ++j) {
    int at[n], count = 0;
    T scale[n];
    for (int k = j; k >= 0; k = above[k]) {
      at[count] = k * n;
      scale[count++] = room[k * n + j] * reciprocal[k];
    }
    detail::in_pieces<n>(0, n, [&](int i) DALEMBERT_IN_BLOCK {
      Lanes<T, p> sum{};
      for (int k = 0; k < count; ++k) sum += broadcast<p, T>(scale[k]) * load<p>(room + at[k] + i);
      store<p, T>(inverse + j * n + i, sum);
    });
  }
}

// result = -a b; b is zero where neither of two coordinates is above the other.
template <int n, class T>
DALEMBERT_BLOCK void negative_product(const int* above, const int* last, const T* a, const T* b, T* result) noexcept {
  constexpr int p = detail::piece<n>;
  for (int j = 0; j < n; ++j) {
    int at[n], count = 0;
    for (int k = above[j]; k >= 0; k = above[k]) at[count++] = k;
    for (int k = j; k <= last[j]; ++k) at[count++] = k;
    detail::in_pieces<n>(0, n, [&](int i) DALEMBERT_IN_BLOCK {
      Lanes<T, p> sum{};
      for (int k = 0; k < count; ++k) sum -= broadcast<p, T>(b[j * n + at[k]]) * load<p>(a + at[k] * n + i);
      store<p, T>(result + j * n + i, sum);
    });
  }
}

}  // namespace dalembert
