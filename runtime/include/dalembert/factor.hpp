// Mass matrices factored along the tree, M = L' D L (Featherstone 2008, section 6.5): what is made of the factors.
//
// Coordinates are numbered depth first: `above` has the coordinate above each (-1: none), `last` the last one beyond each,
// which may be itself. Matrices are n x n, column by column.
#pragma once

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

// inverse = L^-1 D^-1 L^-T. factor: L', of which the elements above the diagonal are read (those of a coordinate and one above
// it); room: n x n, zero but for what an earlier call has left there. Both halves of the inverse are the same bits.
template <int n, class T>
inline void invert(const int* above, const int* last, const T* factor, const T* pivots, T* room, T* inverse) noexcept {
  // Column k of room: row k of L^-1, k and those beyond it: where L^-1's column is not zero.
  for (int k = 0; k < n; ++k) {
    T row[n] = {};
    row[k] = T(1);
    for (int j = above[k]; j >= 0; j = above[j]) {
      const T l = factor[k * n + j];
      for (int i = j; i >= 0; i = above[i]) row[i] -= l * room[i * n + j];
    }
    for (int i = k; i >= 0; i = above[i]) room[i * n + k] = row[i];
  }
  for (int j = 0; j < n; ++j) {
    T column[n] = {};
    for (int k = j; k >= 0; k = above[k]) {
      const T scale = room[k * n + j] / pivots[k];
      const T* from = room + k * n;
      for (int i = j; i <= last[k]; ++i) column[i] += scale * from[i];
    }
    for (int i = j; i < n; ++i) inverse[j * n + i] = column[i];
    for (int i = j + 1; i < n; ++i) inverse[i * n + j] = column[i];
  }
}

// result = -a b; b is zero where neither of two coordinates is above the other.
template <int n, class T>
inline void negative_product(const int* above, const int* last, const T* a, const T* b, T* result) noexcept {
  for (int j = 0; j < n; ++j) {
    T column[n] = {};
    const auto add = [&](int k) {
      const T scale = b[j * n + k];
      for (int i = 0; i < n; ++i) column[i] -= scale * a[k * n + i];
    };
    for (int k = above[j]; k >= 0; k = above[k]) add(k);
    for (int k = j; k <= last[j]; ++k) add(k);
    for (int i = 0; i < n; ++i) result[j * n + i] = column[i];
  }
}

}  // namespace dalembert
