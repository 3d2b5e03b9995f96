// Matrices over all joints, when some are driven by others: their rows and columns are added to their drivers'.
#pragma once

namespace dalembert {

// expanded: n × n, column by column; matrix: nv × nv. coordinate: per row of `expanded` its row of `matrix`; the first `base`
// are the base's own. Driven joints share their driver's coordinate: matrix = Gᵀ expanded G, driven rows of `expanded` being
// per unit of the driver's coordinate already. The base's own block is left as it is.
template <int n, int nv, class T>
inline void reduce(const T* expanded, const int* coordinate, int base, T* matrix) {
  for (int c = 0; c < nv; ++c)
    for (int i = c < base ? base : 0; i < nv; ++i) matrix[c * nv + i] = T(0);
  for (int k = 0; k < n; ++k) {
    const T* from = expanded + k * n;
    T* to = matrix + coordinate[k] * nv;
    for (int i = k < base ? base : 0; i < n; ++i) to[coordinate[i]] += from[i];
  }
}

}  // namespace dalembert
