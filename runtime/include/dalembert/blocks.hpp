// Phase III: the elements of M and C between the joints of limbs, in blocks of fixed size (Shin, Park and Park 2016, eq. 31-39).
//
//   M_ik = F_k·J_i    C_ik = G_k·J_i    C_ki = F_k·J̇_i + H_k·J_i     (i above k, or k itself; H has an angular part alone)
//
// A limb is a run of bodies without branches: its rows and columns are consecutive in M and C. Limbs of equal length stand side
// by side in lanes, slot = first + step·width + lane, and tiles of four steps by four are turned into columns when stored. A limb
// on its own (width 1) has its steps in consecutive slots, and lanes run along them. Nothing is allocated, every loop has a
// length known when the code was generated.
#pragma once

#include "dalembert/lanes.hpp"

namespace dalembert {

// Twists and wrenches of all slots, component by component: component j of slot s at [j * stride + s]. Linear parts first.
template <class T>
struct Panels {
  const T* joint_linear;    // J, 3
  const T* joint_angular;   // J, 3
  const T* joint_rate;      // J̇, 6
  const T* inertia_force;   // F, 6
  const T* bias_force;      // G, 6
  const T* transposed;      // H, 3
  int stride;
};

// Where the limbs of a segment stand. Rows are rows of M and C.
struct LimbTable {
  const int* first_row;  // per lane
  const int* length;     // per lane: real steps, 0 for an empty lane
  int first_slot;
  int steps;             // of the longest
};

enum class Elements { mass = 1, coriolis = 2, both = 3 };
constexpr bool has_mass(Elements e) { return (static_cast<int>(e) & 1) != 0; }
constexpr bool has_coriolis(Elements e) { return (static_cast<int>(e) & 2) != 0; }

namespace detail {

// out[l] = (rows[0][l], rows[1][l], rows[2][l], rows[3][l])
template <class T>
DALEMBERT_INLINE void transpose(const Lanes<T, 4>* rows, Lanes<T, 4>* out) {
  using V = Lanes<T, 4>;
  const V a = __builtin_shufflevector(rows[0], rows[1], 0, 4, 2, 6), b = __builtin_shufflevector(rows[0], rows[1], 1, 5, 3, 7);
  const V c = __builtin_shufflevector(rows[2], rows[3], 0, 4, 2, 6), d = __builtin_shufflevector(rows[2], rows[3], 1, 5, 3, 7);
  out[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
  out[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
  out[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
  out[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}
template <class T>
DALEMBERT_INLINE void transpose(const Lanes<T, 2>* rows, Lanes<T, 4>* out) {
  for (int l = 0; l < 2; ++l) out[l] = Lanes<T, 4>{rows[0][l], rows[1][l], rows[2][l], rows[3][l]};
}

template <class T>
DALEMBERT_INLINE void store_count(T* to, const Lanes<T, 4>& x, int count) {
  if (count >= 4) {
    store<4, T>(to, x);
  } else if (count == 3) {
    store_first<3, 4, T>(to, x);
  } else if (count == 2) {
    store_first<2, 4, T>(to, x);
  } else if (count == 1) {
    *to = x[0];
  }
}

template <int n, class T>
DALEMBERT_INLINE void load_all(Lanes<T, n>* to, const T* from, int count, int stride) {
  for (int j = 0; j < count; ++j) to[j] = load<n, T>(from + j * stride);
}

template <int n, class T>
DALEMBERT_INLINE Lanes<T, n> dot3(const Lanes<T, n>* a, const T* b, int stride) {
  return a[0] * load<n, T>(b) + a[1] * load<n, T>(b + stride) + a[2] * load<n, T>(b + 2 * stride);
}

// What a joint of the upper limb needs: J and J̇, `width` lanes each.
template <class T>
struct Upper {
  const T *linear, *angular, *rate;
  int stride;
};

// One tile of four steps above by four below, for `width` limbs at once.
template <int width, class T>
struct Tile {
  using V = Lanes<T, width>;
  V mass[4][4];     // [above][below]
  V upper[4][4];    // C_ik
  V lower[4][4];    // C_ki
};

template <Elements elements, int width, bool diagonal, class T>
DALEMBERT_INLINE void fill(Tile<width, T>& tile, const Upper<T>& up, int above, const Panels<T>& p, int below) {
  using V = Lanes<T, width>;
  for (int c = 0; c < below; ++c) {
    V f[6], g[6], h[3];
    load_all<width, T>(f, p.inertia_force + c * width, 6, p.stride);
    if constexpr (has_coriolis(elements)) {
      load_all<width, T>(g, p.bias_force + c * width, 6, p.stride);
      load_all<width, T>(h, p.transposed + c * width, 3, p.stride);
    }
    const int end = diagonal ? c + 1 : above;
    for (int r = 0; r < end; ++r) {
      const T *v = up.linear + r * width, *w = up.angular + r * width;
      if constexpr (has_mass(elements)) {
        const V m = dot3<width, T>(f, v, up.stride) + dot3<width, T>(f + 3, w, up.stride);
        tile.mass[r][c] = m;
        if (diagonal) tile.mass[c][r] = m;
      }
      if constexpr (has_coriolis(elements)) {
        const T* d = up.rate + r * width;
        const V below_diagonal = dot3<width, T>(f, d, up.stride) + dot3<width, T>(f + 3, d + 3 * up.stride, up.stride) +
                                 dot3<width, T>(h, w, up.stride);
        const V above_diagonal = dot3<width, T>(g, v, up.stride) + dot3<width, T>(g + 3, w, up.stride);
        if (diagonal) {
          tile.upper[c][r] = below_diagonal;  // of the diagonal itself the second stays
          tile.upper[r][c] = above_diagonal;
        } else {
          tile.lower[r][c] = below_diagonal;
          tile.upper[r][c] = above_diagonal;
        }
      }
    }
  }
}

// Column `column` of each lane's block: values of four consecutive rows, from `rows` on.
template <int width, class T>
DALEMBERT_INLINE void put_column(T* matrix, int leading, const Lanes<T, width>* values, const int* row, const int* column,
                                 const int* count) {
  Lanes<T, 4> turned[width];
  transpose<T>(values, turned);
  for (int l = 0; l < width; ++l)
    if (count[l] > 0) store_count<T>(matrix + column[l] * leading + row[l], turned[l], count[l]);
}

constexpr int least(int a, int b) { return a < b ? a : b; }

// Stores values[above][below] as columns of the lower limb (above runs along the column), or of the upper limb.
template <int width, class T>
DALEMBERT_INLINE void put(T* matrix, int leading, const Lanes<T, width> (*values)[4], bool by_upper, int above, int below,
                          const int* row_above, const int* left_above, const int* row_below, const int* left_below) {
  for (int i = 0; i < (by_upper ? above : below); ++i) {
    Lanes<T, width> line[4];
    int row[width], column[width], count[width];
    for (int j = 0; j < 4; ++j) line[j] = by_upper ? values[i][j] : values[j][i];
    for (int l = 0; l < width; ++l) {
      const int along = by_upper ? least(left_below[l], below) : least(left_above[l], above);
      const bool inside = by_upper ? i < left_above[l] : i < left_below[l];
      row[l] = by_upper ? row_below[l] : row_above[l];
      column[l] = (by_upper ? row_above[l] : row_below[l]) + i;
      count[l] = inside ? along : 0;
    }
    put_column<width, T>(matrix, leading, line, row, column, count);
  }
}

}  // namespace detail

// The block of every limb of a segment with itself, `width` limbs side by side.
// M, C: nv × nv, column by column; steps [begin, end) of the columns, begin a multiple of four.
template <Elements elements, int width, class T>
DALEMBERT_INLINE void limb_blocks(const Panels<T>& panels, const LimbTable& limbs, T* M, T* C, int leading, int begin, int end) {
  for (int c0 = begin; c0 < end; c0 += 4) {
    const int below = detail::least(4, limbs.steps - c0);
    Panels<T> p = panels;
    const int at = limbs.first_slot + c0 * width;
    p.inertia_force += at, p.bias_force += at, p.transposed += at;
    for (int r0 = 0; r0 <= c0; r0 += 4) {
      const int above = detail::least(4, limbs.steps - r0), from = limbs.first_slot + r0 * width;
      const detail::Upper<T> up{panels.joint_linear + from, panels.joint_angular + from, panels.joint_rate + from, panels.stride};
      int row_above[width], left_above[width], row_below[width], left_below[width];
      for (int l = 0; l < width; ++l) {
        row_above[l] = limbs.first_row[l] + r0, left_above[l] = limbs.length[l] - r0;
        row_below[l] = limbs.first_row[l] + c0, left_below[l] = limbs.length[l] - c0;
      }
      detail::Tile<width, T> tile;
      const auto put = [&](T* matrix, const Lanes<T, width> (*values)[4], bool by_upper) {
        detail::put<width, T>(matrix, leading, values, by_upper, above, below, row_above, left_above, row_below, left_below);
      };
      if (r0 == c0) {
        detail::fill<elements, width, true, T>(tile, up, above, p, below);
        if constexpr (has_mass(elements)) put(M, tile.mass, false);
        if constexpr (has_coriolis(elements)) put(C, tile.upper, false);
      } else {
        detail::fill<elements, width, false, T>(tile, up, above, p, below);
        if constexpr (has_mass(elements)) put(M, tile.mass, false), put(M, tile.mass, true);
        if constexpr (has_coriolis(elements)) put(C, tile.upper, false), put(C, tile.lower, true);
      }
    }
  }
}

// The blocks between the limbs of a segment and a limb above each of them, which may be another one for every lane.
// above_slot: [step][lane], the slots of the limbs above (any slot where a lane has none); above: their rows and lengths.
template <Elements elements, int width, int above_steps, class T>
DALEMBERT_INLINE void cross_blocks(const Panels<T>& panels, const LimbTable& limbs, const int* above_slot, const LimbTable& above,
                                   T* M, T* C, int leading, int begin, int end) {
  constexpr int stride = above_steps * width;
  T gathered[12 * stride];
  const T* sources[4] = {panels.joint_linear, panels.joint_angular, panels.joint_rate, panels.joint_rate + 3 * panels.stride};
  for (int part = 0; part < (has_coriolis(elements) ? 4 : 2); ++part)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < stride; ++i) gathered[(3 * part + j) * stride + i] = sources[part][j * panels.stride + above_slot[i]];
  for (int c0 = begin; c0 < end; c0 += 4) {
    const int below = detail::least(4, limbs.steps - c0), at = limbs.first_slot + c0 * width;
    Panels<T> p = panels;
    p.inertia_force += at, p.bias_force += at, p.transposed += at;
    for (int r0 = 0; r0 < above_steps; r0 += 4) {
      const int rows = detail::least(4, above_steps - r0);
      const T* from = gathered + r0 * width;
      const detail::Upper<T> up{from, from + 3 * stride, from + 6 * stride, stride};
      int row_above[width], left_above[width], row_below[width], left_below[width];
      for (int l = 0; l < width; ++l) {
        row_above[l] = above.first_row[l] + r0, left_above[l] = above.length[l] - r0;
        row_below[l] = limbs.first_row[l] + c0, left_below[l] = above.length[l] > 0 ? limbs.length[l] - c0 : 0;
      }
      detail::Tile<width, T> tile;
      detail::fill<elements, width, false, T>(tile, up, rows, p, below);
      const auto put = [&](T* matrix, const Lanes<T, width> (*values)[4], bool by_upper) {
        detail::put<width, T>(matrix, leading, values, by_upper, rows, below, row_above, left_above, row_below, left_below);
      };
      if constexpr (has_mass(elements)) put(M, tile.mass, false), put(M, tile.mass, true);
      if constexpr (has_coriolis(elements)) put(C, tile.upper, false), put(C, tile.lower, true);
    }
  }
}

// Rows and columns of a floating base for the limbs of a segment: M_BJ = F, M_JB = Fᵀ, C_BJ = G, C_JB = Xᵀ. The base's six
// rows come first. `below` holds X, six components per slot.
template <int width, class T>
DALEMBERT_INLINE void base_columns(const T* force, int stride, const LimbTable& limbs, T* matrix, int leading) {
  for (int c = 0; c < limbs.steps; ++c) {
    Lanes<T, width> f[8] = {};
    detail::load_all<width, T>(f, force + limbs.first_slot + c * width, 6, stride);
    int row[width] = {}, row4[width], column[width], four[width], two[width];
    for (int l = 0; l < width; ++l) {
      const bool inside = c < limbs.length[l];
      row4[l] = 4, column[l] = limbs.first_row[l] + c, four[l] = inside ? 4 : 0, two[l] = inside ? 2 : 0;
    }
    detail::put_column<width, T>(matrix, leading, f, row, column, four);
    detail::put_column<width, T>(matrix, leading, f + 4, row4, column, two);
  }
}
template <int width, class T>
DALEMBERT_INLINE void base_rows(const T* force, int stride, const LimbTable& limbs, T* matrix, int leading) {
  for (int r0 = 0; r0 < limbs.steps; r0 += 4) {
    const int rows = detail::least(4, limbs.steps - r0);
    int row[width], count[width];
    for (int l = 0; l < width; ++l)
      row[l] = limbs.first_row[l] + r0, count[l] = detail::least(rows, limbs.length[l] - r0);
    for (int j = 0; j < 6; ++j) {
      Lanes<T, width> f[4] = {};
      int column[width];
      for (int i = 0; i < rows; ++i) f[i] = load<width, T>(force + j * stride + limbs.first_slot + (r0 + i) * width);
      for (int l = 0; l < width; ++l) column[l] = j;
      detail::put_column<width, T>(matrix, leading, f, row, column, count);
    }
  }
}

}  // namespace dalembert
