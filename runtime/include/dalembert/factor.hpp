// Whether a mass matrix can be solved with.
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

}  // namespace dalembert
