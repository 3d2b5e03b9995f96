// The wrench influence matrix of any tree: transposed body Jacobians (Shin, Park and Park 2016, eq. 17).
#pragma once

#include "dalembert/lanes.hpp"

namespace dalembert {

// Per body, in depth-first order.
template <class T>
struct BodyTable {
  const int* slot;
  const int* parent;               // -1: the base
  const T (*link_rotation)[9];     // the link's axes in the body's frame, row by row
  const T (*link_translation)[3];  // the link's origin in the body's frame
};

// Fills the six columns of every body: W(row of joint i, columns of body b) = the twist of b's link in its own axes, linear
// part first, per unit rate of i. `rotation`: column by column, `stride` apart, as Phase I keeps it; `base`: its rows, 6 when
// it floats, else 0.
template <class T>
inline void wrench_columns(const BodyTable<T>& table, int bodies, const T* rotation, const T* position, const T* joint_linear,
                           const T* joint_angular, int stride, int base, T* W, int rows) {
  const auto put = [&](int row, int column, const T(&r)[3][3], const T* v, const T* w) {
    for (int j = 0; j < 3; ++j) {
      W[row + rows * (column + j)] = r[0][j] * v[0] + r[1][j] * v[1] + r[2][j] * v[2];
      W[row + rows * (column + j + 3)] = r[0][j] * w[0] + r[1][j] * w[1] + r[2][j] * w[2];
    }
  };
  for (int i = 0; i < base; ++i) W[i + rows * i] = T(1);
  for (int b = 0; b < bodies; ++b) {
    const int s = table.slot[b], column = base + 6 * b;
    T r[3][3], p[3];  // the link's frame in the frame of reference
    for (int i = 0; i < 3; ++i) {
      const T x = rotation[i * stride + s], y = rotation[(3 + i) * stride + s], z = rotation[(6 + i) * stride + s];
      for (int j = 0; j < 3; ++j)
        r[i][j] = x * table.link_rotation[b][j] + y * table.link_rotation[b][3 + j] + z * table.link_rotation[b][6 + j];
      p[i] = position[i * stride + s] + x * table.link_translation[b][0] + y * table.link_translation[b][1] +
             z * table.link_translation[b][2];
    }
    for (int k = b; k >= 0; k = table.parent[k]) {
      const int a = table.slot[k];
      const T w[3] = {joint_angular[a], joint_angular[stride + a], joint_angular[2 * stride + a]};
      const T v[3] = {joint_linear[a] + w[1] * p[2] - w[2] * p[1], joint_linear[stride + a] + w[2] * p[0] - w[0] * p[2],
                      joint_linear[2 * stride + a] + w[0] * p[1] - w[1] * p[0]};
      put(base + k, column, r, v, w);
    }
    for (int i = 0; i < base; ++i) {
      T v[3] = {}, w[3] = {};
      if (i < 3) {
        v[i] = T(1);
      } else {
        w[i - 3] = T(1);
        v[0] = w[1] * p[2] - w[2] * p[1], v[1] = w[2] * p[0] - w[0] * p[2], v[2] = w[0] * p[1] - w[1] * p[0];
      }
      put(i, column, r, v, w);
    }
  }
}

}  // namespace dalembert
