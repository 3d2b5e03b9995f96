// Tiles of M and C: four joints by four, for as many limbs at once as there are lanes, filled from twists and wrenches and
// stored as columns (Shin, Park and Park 2016, eq. 31-39; the equations stand in blocks.hpp).
//
// Every function is inlined into a block of blocks.hpp, whose sizes are constants: what depends on them alone costs nothing.
#pragma once

#include <initializer_list>
#include <utility>

#include "dalembert/lanes.hpp"

namespace dalembert {

// Twists and wrenches of all slots, component by component: component j of slot s at [j * stride + s]. Linear parts first.
template <class T>
struct Panels {
  const T* joint_linear;   // J, 3
  const T* joint_angular;  // J, 3
  const T* joint_rate;     // J̇, 6
  const T* inertia_force;  // F, 6
  const T* bias_force;     // G, 6
  const T* transposed;     // H, 3
  int stride;
};

enum class Elements { mass = 1, coriolis = 2, both = 3 };
constexpr bool has_mass(Elements e) { return (static_cast<int>(e) & 1) != 0; }
constexpr bool has_coriolis(Elements e) { return (static_cast<int>(e) & 2) != 0; }

namespace detail {

// Limbs up to this length have their blocks written out; longer ones run through loops, which keeps the code in the cache.
inline constexpr int short_limb = 8;

template <class F, int... i>
DALEMBERT_INLINE void write_out(std::integer_sequence<int, i...>, int count, const F& f) {
  (void)std::initializer_list<int>{(i < count ? (f(i), 0) : 0)...};
}

// f(0), …, f(count − 1), written out when `out` says so (count is then at most `most`, and known to the compiler).
template <bool out, int most, class F>
DALEMBERT_INLINE void repeat(int count, const F& f) {
  if constexpr (out) {
    write_out(std::make_integer_sequence<int, most>{}, count, f);
  } else {
    for (int i = 0; i < count; ++i) f(i);
  }
}

// f(0), …, f(width − 1), never a loop: what depends on the limbs' tables alone is then worked out by the compiler.
template <int width, class F>
DALEMBERT_INLINE void lanes(const F& f) {
  write_out(std::make_integer_sequence<int, width>{}, width, f);
}

// Column l of four rows of `width` lanes: out[l] = (rows[0][l], rows[1][l], rows[2][l], rows[3][l]).
template <class T>
DALEMBERT_INLINE void transpose(const Lanes<T, 4>* rows, Lanes<T, 4>* out) {
#if defined(__AVX512F__) && defined(__clang__)  // GCC 12 joins registers by way of memory
  using W = Lanes<T, 8>;                        // two permutations of registers twice as wide
  const W upper = __builtin_shufflevector(rows[0], rows[1], 0, 1, 2, 3, 4, 5, 6, 7);
  const W lower = __builtin_shufflevector(rows[2], rows[3], 0, 1, 2, 3, 4, 5, 6, 7);
  const W first = __builtin_shufflevector(upper, lower, 0, 4, 8, 12, 1, 5, 9, 13);
  const W last = __builtin_shufflevector(upper, lower, 2, 6, 10, 14, 3, 7, 11, 15);
  out[0] = __builtin_shufflevector(first, first, 0, 1, 2, 3);
  out[1] = __builtin_shufflevector(first, first, 4, 5, 6, 7);
  out[2] = __builtin_shufflevector(last, last, 0, 1, 2, 3);
  out[3] = __builtin_shufflevector(last, last, 4, 5, 6, 7);
#else
  using V = Lanes<T, 4>;
  const V a = __builtin_shufflevector(rows[0], rows[1], 0, 4, 2, 6), b = __builtin_shufflevector(rows[0], rows[1], 1, 5, 3, 7);
  const V c = __builtin_shufflevector(rows[2], rows[3], 0, 4, 2, 6), d = __builtin_shufflevector(rows[2], rows[3], 1, 5, 3, 7);
  out[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
  out[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
  out[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
  out[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
#endif
}
template <class T>
DALEMBERT_INLINE void transpose(const Lanes<T, 2>* rows, Lanes<T, 4>* out) {
  const Lanes<T, 4> a = __builtin_shufflevector(rows[0], rows[1], 0, 2, 1, 3),
                    b = __builtin_shufflevector(rows[2], rows[3], 0, 2, 1, 3);
  out[0] = __builtin_shufflevector(a, b, 0, 1, 4, 5);
  out[1] = __builtin_shufflevector(a, b, 2, 3, 6, 7);
}

// The same for two rows.
template <class T>
DALEMBERT_INLINE void transpose_pair(const Lanes<T, 4>* rows, Lanes<T, 2>* out) {
  const Lanes<T, 4> a = __builtin_shufflevector(rows[0], rows[1], 0, 4, 2, 6),
                    b = __builtin_shufflevector(rows[0], rows[1], 1, 5, 3, 7);
  out[0] = __builtin_shufflevector(a, a, 0, 1);
  out[1] = __builtin_shufflevector(b, b, 0, 1);
  out[2] = __builtin_shufflevector(a, a, 2, 3);
  out[3] = __builtin_shufflevector(b, b, 2, 3);
}
template <class T>
DALEMBERT_INLINE void transpose_pair(const Lanes<T, 2>* rows, Lanes<T, 2>* out) {
  out[0] = __builtin_shufflevector(rows[0], rows[1], 0, 2);
  out[1] = __builtin_shufflevector(rows[0], rows[1], 1, 3);
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

constexpr int least(int a, int b) { return a < b ? a : b; }

// J and J̇ of the joints above, a row per component; J̇ null without C.
template <class T>
struct Upper {
  const T *linear, *angular, *rate;
  int stride;  // from component to component
  int step;    // from joint to joint

  Upper from(int joint) const {
    return {linear + joint * step, angular + joint * step, rate == nullptr ? nullptr : rate + joint * step, stride, step};
  }
};

// How they stand there: a limb above every lane, or one limb above all of them.
enum class Above { each, one };

template <Above above, int n, class T>
DALEMBERT_INLINE Lanes<T, n> read_above(const T* from) {
  if constexpr (above == Above::each) {
    return load<n, T>(from);
  } else {
    return broadcast<n, T>(*from);
  }
}

template <Above above, int n, class T>
DALEMBERT_INLINE Lanes<T, n> dot3(const Lanes<T, n>* a, const T* b, int stride) {
  return a[0] * read_above<above, n, T>(b) + a[1] * read_above<above, n, T>(b + stride) +
         a[2] * read_above<above, n, T>(b + 2 * stride);
}

// sum + a·b as one chain of multiply-adds: adding the product up first would take an addition more.
template <Above above, int n, class T>
DALEMBERT_INLINE Lanes<T, n> add_dot3(Lanes<T, n> sum, const Lanes<T, n>* a, const T* b, int stride) {
  for (int j = 0; j < 3; ++j) sum += a[j] * read_above<above, n, T>(b + j * stride);
  return sum;
}

// One tile of four steps above by four below, for `width` limbs at once.
template <int width, class T>
struct Tile {
  using V = Lanes<T, width>;
  V mass[4][4];   // [above][below]
  V upper[4][4];  // C_ik
  V lower[4][4];  // C_ki
};

template <Elements elements, Above kind, int width, bool diagonal, bool out, class T>
DALEMBERT_INLINE void fill(Tile<width, T>& tile, const Upper<T>& up, int above, const Panels<T>& p, int below) {
  using V = Lanes<T, width>;
  repeat<out, 4>(
      below, [&](int c) __attribute__((always_inline)) {
        V f[6], g[6], h[3];
        load_all<width, T>(f, p.inertia_force + c * width, 6, p.stride);
        if constexpr (has_coriolis(elements)) {
          load_all<width, T>(g, p.bias_force + c * width, 6, p.stride);
          load_all<width, T>(h, p.transposed + c * width, 3, p.stride);
        }
        repeat<out, 4>(
            diagonal ? c + 1 : above, [&](int r) __attribute__((always_inline)) {
              const T *v = up.linear + r * up.step, *w = up.angular + r * up.step;
              if constexpr (has_mass(elements)) {
                const V m = add_dot3<kind, width, T>(dot3<kind, width, T>(f, v, up.stride), f + 3, w, up.stride);
                tile.mass[r][c] = m;
                if (diagonal) tile.mass[c][r] = m;
              }
              if constexpr (has_coriolis(elements)) {
                const V above_diagonal = add_dot3<kind, width, T>(dot3<kind, width, T>(g, v, up.stride), g + 3, w, up.stride);
                tile.upper[r][c] = above_diagonal;
                if (diagonal && r == c) return;
                const T* d = up.rate + r * up.step;
                const V forced =
                    add_dot3<kind, width, T>(dot3<kind, width, T>(f, d, up.stride), f + 3, d + 3 * up.stride, up.stride);
                const V below_diagonal = add_dot3<kind, width, T>(forced, h, w, up.stride);
                (diagonal ? tile.upper[c][r] : tile.lower[r][c]) = below_diagonal;
              }
            });
      });
}

// A column of each lane's block: values of up to four consecutive rows, from to[lane] on. Where a lane is joined to the next,
// the next lane's rows follow its own: what is stored beyond its last row is overwritten.
template <int width, class T>
DALEMBERT_INLINE void put_column(T* const* to, const Lanes<T, width>* values, const int* count, int along,
                                 const bool* joined = nullptr) {
  if (along == 1) {
    lanes<width>([&](int l) __attribute__((always_inline)) {
      if (count[l] > 0) *to[l] = values[0][l];
    });
  } else if (along == 2) {
    Lanes<T, 2> turned[width];
    transpose_pair<T>(values, turned);
    lanes<width>([&](int l) __attribute__((always_inline)) {
      if (count[l] > 1) {
        store<2, T>(to[l], turned[l]);
      } else if (count[l] == 1) {
        *to[l] = turned[l][0];
      }
    });
  } else {
    Lanes<T, 4> turned[width];
    transpose<T>(values, turned);
    lanes<width>([&](int l) __attribute__((always_inline)) {
      const bool whole = joined != nullptr && joined[l] && count[l] == 3 && count[l + 1] > 0;
      store_count<T>(to[l], turned[l], whole ? 4 : count[l]);
    });
  }
}

// A tile's place in M or C, lane by lane: first rows, and how many real steps there are from there on.
template <int width>
struct Place {
  int row_above[width], left_above[width], row_below[width], left_below[width];
};

// Stores values[above][below] as columns of the lower limb's joints (rows run over `above`), or of the upper limb's.
template <bool by_upper, bool out, int width, class T>
DALEMBERT_INLINE void put(T* matrix, int leading, const Lanes<T, width> (*values)[4], int above, int below,
                          const Place<width>& at) {
  const int along = by_upper ? below : above;
  T* to[width];
  int count[width];
  const int* row = by_upper ? at.row_below : at.row_above;
  const int* column = by_upper ? at.row_above : at.row_below;
  const int* left = by_upper ? at.left_below : at.left_above;
  const int* across = by_upper ? at.left_above : at.left_below;
  bool joined[width];
  lanes<width>([&](int l) __attribute__((always_inline)) {
    to[l] = matrix + column[l] * leading + row[l];
    joined[l] = l + 1 < width && column[l + 1] == column[l] && row[l + 1] == row[l] + along;
  });
  repeat<out, 4>(
      by_upper ? above : below, [&](int i) __attribute__((always_inline)) {
        Lanes<T, width> line[4] = {};
        T* here[width];
        write_out(
            std::make_integer_sequence<int, 4>{},
            along, [&](int j) __attribute__((always_inline)) { line[j] = by_upper ? values[i][j] : values[j][i]; });
        detail::lanes<width>([&](int l) __attribute__((always_inline)) {
          here[l] = to[l] + i * leading;
          count[l] = i < across[l] ? least(left[l], along) : 0;
        });
        put_column<width, T>(here, line, count, along, joined);
      });
}

// Both triangles of an off-diagonal tile, or the whole of a diagonal one.
template <Elements elements, Above kind, int width, bool diagonal, bool out, class T>
DALEMBERT_INLINE void tile_into(const Panels<T>& p, const Upper<T>& up, int above, int below, const Place<width>& at, T* M,
                                T* C, int leading) {
  Tile<width, T> tile;
  fill<elements, kind, width, diagonal, out, T>(tile, up, above, p, below);
  if constexpr (has_mass(elements)) {
    put<false, out, width, T>(M, leading, tile.mass, above, below, at);
    if (!diagonal) put<true, out, width, T>(M, leading, tile.mass, above, below, at);
  }
  if constexpr (has_coriolis(elements)) {
    put<false, out, width, T>(C, leading, tile.upper, above, below, at);
    if (!diagonal) put<true, out, width, T>(C, leading, tile.lower, above, below, at);
  }
}

}  // namespace detail

}  // namespace dalembert
