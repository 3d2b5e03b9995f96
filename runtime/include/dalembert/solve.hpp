// Mass matrices factored after they were formed, M = U D U' (Featherstone 2008, section 6.3), U = L' being unit upper
// triangular, and solved with. Eliminated from the last coordinate to the first, U is zero wherever neither of two coordinates
// is above the other: a column has as many elements as its coordinate has others above it.
//
// Coordinates are taken a chain at a time as in factor.hpp: those above a chain are all of the chains above it. Matrices are n
// x n, column by column. U's array has D on its diagonal; what is zero in U is not written.
#pragma once

#include <dalembert/factor.hpp>

namespace dalembert {

// The chains that coordinates stand in.
struct Chains {
  int count;
  const int* begin;  // first coordinate of each, and behind the last of them n
  const int* above;  // the chain directly above each, -1: none
  const int* depth;  // how many coordinates stand above each
};

namespace detail {

// f(first coordinate, coordinate behind the last one, how many above the first) for each chain above one, the nearest first.
template <class F>
static DALEMBERT_INLINE void each_above(const Chains& chains, int chain, const F& f) {
  for (int c = chains.above[chain]; c >= 0; c = chains.above[c]) f(chains.begin[c], chains.begin[c + 1], chains.depth[c]);
}

// to -= factor from, as far as `count` elements reach.
template <class T>
static DALEMBERT_INLINE void subtract(const T& factor, const T* from, T* to, int count) {
  constexpr int w = native_lanes;
  for (int i = 0; i < count; i += w) store<w, T>(to + i, load<w>(to + i) - broadcast<w, T>(factor) * load<w>(from + i));
}

// The same of chains that are constants, which f gets as constants: first coordinate, how many there are, how many above.
template <const Chains& chains, int chain, class F>
static DALEMBERT_INLINE void each_constant_above(const F& f) {
  constexpr int c = chains.above[chain];
  if constexpr (c >= 0) {
    f(std::integral_constant<int, chains.begin[c]>{}, std::integral_constant<int, chains.begin[c + 1] - chains.begin[c]>{},
      std::integral_constant<int, chains.depth[c]>{});
    each_constant_above<chains, c>(f);
  }
}

// f(count), a number from 1 to `most`, as a constant.
template <int most, class F>
static DALEMBERT_INLINE void with_constant(int count, const F& f) {
  if (count == most) f(std::integral_constant<int, most>{});
  else if constexpr (most > 1) with_constant<most - 1>(count, f);
}

// Columns of a chain, `depth` rows above its own m, from the last to the first: each less its multiples of those behind it.
template <int m, int depth, int stride, class T>
static DALEMBERT_INLINE void eliminate_own(T* columns, T (&reciprocal)[m]) {
  constexpr int w = native_lanes, pieces = (depth + m + w - 1) / w;
  if constexpr (m * pieces <= (doubles_in_register < 8 ? 12 : 24)) {  // in registers
    Lanes<T, w> column[m][pieces];
    for_constants<m>([&](auto k) DALEMBERT_IN_BLOCK {
      for_constants<(depth + k) / w + 1>([&](auto i)
                                             DALEMBERT_IN_BLOCK { column[k][i] = load<w>(columns + k * stride + i * w); });
    });
    for_constants<m>([&](auto back) DALEMBERT_IN_BLOCK {
      constexpr int k = m - 1 - decltype(back)::value;
      reciprocal[k] = T(1) / lane<w, T>(column[k][(depth + k) / w], (depth + k) % w);
      for_constants<k>([&](auto other) DALEMBERT_IN_BLOCK {
        constexpr int j = decltype(other)::value;
        const Lanes<T, w> times = broadcast<w, T>(lane<w, T>(column[k][(depth + j) / w], (depth + j) % w) * reciprocal[k]);
        for_constants<(depth + j) / w + 1>([&](auto i) DALEMBERT_IN_BLOCK { column[j][i] -= times * column[k][i]; });
      });
      for_constants<(depth + k) / w + 1>([&](auto i)
                                             DALEMBERT_IN_BLOCK { store<w, T>(columns + k * stride + i * w, column[k][i]); });
    });
  } else {
    for (int k = m - 1; k >= 0; --k) {
      const T* const own = columns + k * stride;
      reciprocal[k] = T(1) / own[depth + k];
      for (int j = 0; j < k; ++j) subtract<T>(own[depth + j] * reciprocal[k], own, columns + j * stride, depth + j + 1);
    }
  }
}

// Rows of U in the columns of a chain of m, and the columns of `count` coordinates above it less their multiples of these:
// coordinates from `begin` on, of which the first has `at` others above it.
template <int n, int m, int stride, class T>
static DALEMBERT_INLINE void eliminate_above(int first, int begin, int count, int at, const T* reciprocal, T* room, T* factor) {
  constexpr int w = native_lanes;
  const T* const columns = room + first * stride;
  for (int i = begin; i < begin + count; ++i) {
    const int own = at + i - begin;
    T* const column = room + i * stride;
    T factors[m];
    for_constants<m>([&](auto k) DALEMBERT_IN_BLOCK {
      factor[(first + k) * n + i] = factors[k] = columns[k * stride + own] * reciprocal[k];
    });
    DALEMBERT_KEEP_LOOP
    for (int j = 0; j <= own; j += w) {
      Lanes<T, w> rest = load<w>(column + j);
      for_constants<m>([&](auto k)
                           DALEMBERT_IN_BLOCK { rest -= broadcast<w, T>(factors[k]) * load<w>(columns + k * stride + j); });
      store<w, T>(column + j, rest);
    }
  }
}

}  // namespace detail

template <int n, int longest, class T>
__attribute__((noinline)) static void factorise_in_loops(const T* mass, const Chains& chains, T* room, T* factor, T* pivots,
                                                         T* diagonal) noexcept {
  constexpr int stride = factor_stride(longest), w = native_lanes;
  for (int c = 0; c < chains.count; ++c) {
    const int first = chains.begin[c], end = chains.begin[c + 1], depth = chains.depth[c];
    for (int k = first; k < end; ++k) {
      T* const column = room + k * stride;
      const T* const from = mass + k * n;
      for (int i = 0; i < stride; i += w) store<w, T>(column + i, Lanes<T, w>{});
      detail::each_above(chains, c, [&](int begin, int behind, int at) DALEMBERT_IN_BLOCK {
        for (int i = begin; i < behind; ++i) column[at + i - begin] = from[i];
      });
      for (int i = first; i <= k; ++i) column[depth + i - first] = from[i];
      diagonal[k] = from[k];
    }
  }
  for (int c = chains.count - 1; c >= 0; --c) {
    const int first = chains.begin[c], end = chains.begin[c + 1], depth = chains.depth[c];
    T reciprocal[longest_chain];
    for (int k = end - 1; k >= first; --k) {
      T* const column = room + k * stride;
      pivots[k] = column[depth + k - first];
      reciprocal[k - first] = T(1) / pivots[k];
      for (int i = first; i < k; ++i)
        detail::subtract<T>(column[depth + i - first] * reciprocal[k - first], column, room + i * stride,
                            depth + i - first + 1);
    }
    detail::with_constant<longest_chain>(end - first, [&](auto m) DALEMBERT_IN_BLOCK {
      detail::each_above(chains, c, [&](int begin, int behind, int at) DALEMBERT_IN_BLOCK {
        detail::eliminate_above<n, m, stride>(first, begin, behind - begin, at, reciprocal, room, factor);
      });
    });
    for (int k = first; k < end; ++k) {
      for (int i = first; i < k; ++i) factor[k * n + i] = room[k * stride + depth + i - first] * reciprocal[k - first];
      factor[k * n + k] = pivots[k];
    }
  }
}

// mass: M. room: factor_stride(longest) * n elements, for U D, where no coordinate has more than longest - 1 others above it:
// of its column those elements alone, the tree's root first. Pivots and M's diagonal are what factor_status() tells by whether
// U means anything.
template <int n, int longest, const Chains& chains, class T>
__attribute__((noinline)) static void factorise(const T* mass, T* room, T* factor, T* pivots, T* diagonal) noexcept {
  if constexpr (n > most_written_out) {
    factorise_in_loops<n, longest>(mass, chains, room, factor, pivots, diagonal);
  } else {
    constexpr int stride = factor_stride(longest);
    // The last chain first, which is read first. Registers that reach beyond a column have zeros there.
    detail::for_constants<chains.count>([&](auto back) DALEMBERT_IN_BLOCK {
      constexpr int c = chains.count - 1 - decltype(back)::value, first = chains.begin[c], depth = chains.depth[c];
      detail::for_constants<chains.begin[c + 1] - first>([&](auto own) DALEMBERT_IN_BLOCK {
        constexpr int k = first + decltype(own)::value, size = depth + k - first + 1;
        T* const column = room + k * stride;
        const T* const from = mass + k * n;
        for (int i = size; i < padded(size); ++i) column[i] = T(0);
        detail::each_constant_above<chains, c>([&](auto begin, auto count, auto at) DALEMBERT_IN_BLOCK {
          for (int i = 0; i < count; ++i) column[at + i] = from[begin + i];
        });
        for (int i = 0; i <= k - first; ++i) column[depth + i] = from[first + i];
        diagonal[k] = from[k];
      });
    });
    detail::for_constants<chains.count>([&](auto back) DALEMBERT_IN_BLOCK {
      constexpr int c = chains.count - 1 - decltype(back)::value, first = chains.begin[c], m = chains.begin[c + 1] - first,
                    depth = chains.depth[c];
      T* const columns = room + first * stride;
      T reciprocal[m];
      detail::eliminate_own<m, depth, stride>(columns, reciprocal);
      detail::each_constant_above<chains, c>([&](auto begin, auto count, auto at) DALEMBERT_IN_BLOCK {
        detail::eliminate_above<n, m, stride>(first, begin, count, at, reciprocal, room, factor);
      });
      detail::for_constants<m>([&](auto own) DALEMBERT_IN_BLOCK {
        constexpr int k = decltype(own)::value;
        const T* const column = columns + k * stride + depth;
        for (int i = 0; i < k; ++i) factor[(first + k) * n + first + i] = column[i] * reciprocal[k];
        factor[(first + k) * n + first + k] = pivots[first + k] = column[k];
      });
    });
  }
}

// Columns of b, n numbers each and `stride` elements apart, become (U D U')^-1 b: as many as there are lanes, or fewer.
template <int n, int w, class T>
__attribute__((noinline)) static void solve_columns(const Chains& chains, const T* factor, T* b, int columns,
                                                    int stride) noexcept {
  Lanes<T, w> x[n];
  for (int k = 0; k < n; ++k) x[k] = each_lane<w, T>([=](int lane) { return b[(lane < columns ? lane : 0) * stride + k]; });
  // x[i] loses U's elements of some columns times those of x.
  const auto rest = [&](int i, int from, int behind) DALEMBERT_IN_BLOCK {
    Lanes<T, w> sum = x[i];
    for (int k = from; k < behind; ++k) sum -= broadcast<w, T>(factor[k * n + i]) * x[k];
    x[i] = sum;
  };
  for (int c = chains.count - 1; c >= 0; --c) {
    const int first = chains.begin[c], end = chains.begin[c + 1];
    for (int i = end - 2; i >= first; --i) rest(i, i + 1, end);
    detail::each_above(chains, c, [&](int begin, int behind, int) DALEMBERT_IN_BLOCK {
      for (int i = begin; i < behind; ++i) rest(i, first, end);
    });
  }
  for (int k = 0; k < n; ++k) x[k] = x[k] / broadcast<w, T>(factor[k * n + k]);
  for (int c = 0; c < chains.count; ++c) {
    const int first = chains.begin[c], end = chains.begin[c + 1];
    for (int k = first; k < end; ++k) {
      Lanes<T, w> sum = x[k];
      const auto subtract = [&](int begin, int behind, int) DALEMBERT_IN_BLOCK {
        for (int i = begin; i < behind; ++i) sum -= broadcast<w, T>(factor[k * n + i]) * x[i];
      };
      detail::each_above(chains, c, subtract);
      subtract(first, k, 0);
      x[k] = sum;
    }
  }
  for (int lane = 0; lane < columns; ++lane)
    for (int k = 0; k < n; ++k) b[lane * stride + k] = dalembert::lane<w, T>(x[k], lane);
}

// One column, b = (U D U')^-1 b.
template <int n, const Chains& chains, class T>
__attribute__((noinline)) static void solve_one(const T* factor, T* b) noexcept {
  if constexpr (n > most_written_out) {
    solve_columns<n, 1>(chains, factor, b, 1, n);
  } else {
    detail::for_constants<chains.count>([&](auto back) DALEMBERT_IN_BLOCK {
      constexpr int c = chains.count - 1 - decltype(back)::value, first = chains.begin[c], m = chains.begin[c + 1] - first;
      T x[m];
      detail::for_constants<m>([&](auto k) DALEMBERT_IN_BLOCK { x[k] = b[first + k]; });
      detail::for_constants<m>([&](auto own) DALEMBERT_IN_BLOCK {
        constexpr int k = m - 1 - decltype(own)::value;
        detail::for_constants<k>([&](auto i) DALEMBERT_IN_BLOCK { x[i] -= factor[(first + k) * n + first + i] * x[k]; });
      });
      detail::each_constant_above<chains, c>([&](auto begin, auto count, auto) DALEMBERT_IN_BLOCK {
        detail::each_piece<count>([&](auto lanes, auto at) DALEMBERT_IN_BLOCK {
          constexpr int w = decltype(lanes)::value, from = begin + decltype(at)::value;
          Lanes<T, w> rest = load<w>(b + from);
          detail::for_constants<m>(
              [&](auto k) DALEMBERT_IN_BLOCK { rest -= broadcast<w, T>(x[k]) * load<w>(factor + (first + k) * n + from); });
          store<w, T>(b + from, rest);
        });
      });
      detail::for_constants<m>([&](auto k) DALEMBERT_IN_BLOCK { b[first + k] = x[k] / factor[(first + k) * n + first + k]; });
    });
    detail::for_constants<chains.count>([&](auto chain) DALEMBERT_IN_BLOCK {
      constexpr int c = decltype(chain)::value, first = chains.begin[c], m = chains.begin[c + 1] - first;
      T x[m];
      detail::for_constants<m>([&](auto k) DALEMBERT_IN_BLOCK { x[k] = b[first + k]; });
      detail::each_constant_above<chains, c>([&](auto begin, auto count, auto) DALEMBERT_IN_BLOCK {
        detail::for_constants<count>([&](auto i) DALEMBERT_IN_BLOCK {
          detail::for_constants<m>([&](auto k)
                                       DALEMBERT_IN_BLOCK { x[k] -= factor[(first + k) * n + begin + i] * b[begin + i]; });
        });
      });
      detail::for_constants<m>([&](auto k) DALEMBERT_IN_BLOCK {
        detail::for_constants<decltype(k)::value>(
            [&](auto i) DALEMBERT_IN_BLOCK { x[k] -= factor[(first + k) * n + first + i] * x[i]; });
        b[first + k] = x[k];
      });
    });
  }
}

// b, n numbers each in columns `stride` elements apart, becomes M^-1 b; zero, and false, where M could not be factored or has
// not been yet: U and D are zero then.
template <int n, class T>
static inline bool solve(const Chains& chains, const T* factor, T* b, int columns, int stride) noexcept {
  const bool factored = factor[0] > T(0);
  for (int first = 0; first < columns; first += native_lanes) {
    const int count = least(native_lanes, columns - first);
    T* const column = b + first * stride;
    if (!factored) {
      for (int k = 0; k < count * n; ++k) column[k / n * stride + k % n] = T(0);
    } else if (count == 1) {
      solve_columns<n, 1>(chains, factor, column, 1, stride);
    } else {
      solve_columns<n, native_lanes>(chains, factor, column, count, stride);
    }
  }
  return factored;
}

}  // namespace dalembert
