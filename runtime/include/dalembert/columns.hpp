// Columns of matrices, written a few rows at a time for as many limbs at once as there are lanes.
//
// Every function is inlined into a block of blocks.hpp or runs.hpp, whose sizes and tables are constants: what depends on them
// alone costs nothing.
#pragma once

#include <initializer_list>
#include <type_traits>
#include <utility>

#include "dalembert/lanes.hpp"

namespace dalembert {

// Where a matrix over all joints goes when some joints are driven by others: what stands between the other joints to `matrix`,
// the driven joints' columns, `size` elements each, to `driven`, and behind all of these their rows. add_mimic() adds
// those to their drivers'. coordinate: per joint, base's coordinates first, its row of `matrix`; −1, −2, … for driven ones.
template <class T>
struct Reduced {
  T* matrix;
  T* driven;
  const int* coordinate;
  int size, count;  // of `coordinate`; of driven joints

  T* driven_column(int column) const { return driven + (-1 - coordinate[column]) * size; }
  T* driven_row(int row) const { return driven_column(row) + count * size; }
  T* at(int row, int column, int leading) const {
    if (coordinate[column] < 0) return driven_column(column) + row;
    if (coordinate[row] < 0) return driven_row(row) + column;
    return matrix + coordinate[column] * leading + coordinate[row];
  }
};

// Adds columns and rows of driven joints to their drivers': matrix[to[i]] = or += driven[from[i]]. The first `set` elements
// are nobody else's and are set.
template <class T>
static inline void add_mimic(const T* driven, const int* from, const int* to, int set, int count, T* matrix) {
  for (int i = 0; i < set; ++i) matrix[to[i]] = driven[from[i]];
  for (int i = set; i < count; ++i) matrix[to[i]] += driven[from[i]];
}

namespace detail {

template <class F, int... i>
DALEMBERT_BLOCK void write_out(std::integer_sequence<int, i...>, int count, const F& f) {
  (void)std::initializer_list<int>{(i < count ? (f(i), 0) : 0)...};
}

// f(0), …, f(width − 1), never a loop: what depends on the limbs' tables alone is then worked out by the compiler.
template <int width, class F>
DALEMBERT_BLOCK void lanes(const F& f) {
  write_out(std::make_integer_sequence<int, width>{}, width, f);
}

// Column l of four rows of `width` lanes: out[l] = (rows[0][l], rows[1][l], rows[2][l], rows[3][l]).
template <class T>
static DALEMBERT_INLINE void transpose(const Lanes<T, 4>* rows, Lanes<T, 4>* out) {
#if defined(__AVX512F__) && defined(__clang__)  // GCC 12 joins registers by way of memory
  using W = Lanes<T, 8>;                        // two permutations of registers twice as wide
  const W upper = shuffled<T, 0, 1, 2, 3, 4, 5, 6, 7>(rows[0], rows[1]);
  const W lower = shuffled<T, 0, 1, 2, 3, 4, 5, 6, 7>(rows[2], rows[3]);
  const W first = shuffled<T, 0, 4, 8, 12, 1, 5, 9, 13>(upper, lower);
  const W last = shuffled<T, 2, 6, 10, 14, 3, 7, 11, 15>(upper, lower);
  out[0] = shuffled<T, 0, 1, 2, 3>(first, first);
  out[1] = shuffled<T, 4, 5, 6, 7>(first, first);
  out[2] = shuffled<T, 0, 1, 2, 3>(last, last);
  out[3] = shuffled<T, 4, 5, 6, 7>(last, last);
#else
  using V = Lanes<T, 4>;
  const V a = shuffled<T, 0, 4, 2, 6>(rows[0], rows[1]), b = shuffled<T, 1, 5, 3, 7>(rows[0], rows[1]);
  const V c = shuffled<T, 0, 4, 2, 6>(rows[2], rows[3]), d = shuffled<T, 1, 5, 3, 7>(rows[2], rows[3]);
  out[0] = shuffled<T, 0, 1, 4, 5>(a, c);
  out[1] = shuffled<T, 0, 1, 4, 5>(b, d);
  out[2] = shuffled<T, 2, 3, 6, 7>(a, c);
  out[3] = shuffled<T, 2, 3, 6, 7>(b, d);
#endif
}
template <class T>
static DALEMBERT_INLINE void transpose(const Lanes<T, 2>* rows, Lanes<T, 4>* out) {
  const Lanes<T, 4> a = shuffled<T, 0, 2, 1, 3>(rows[0], rows[1]), b = shuffled<T, 0, 2, 1, 3>(rows[2], rows[3]);
  out[0] = shuffled<T, 0, 1, 4, 5>(a, b);
  out[1] = shuffled<T, 2, 3, 6, 7>(a, b);
}

// The same for two rows.
template <class T>
static DALEMBERT_INLINE void transpose_pair(const Lanes<T, 4>* rows, Lanes<T, 2>* out) {
  const Lanes<T, 4> a = shuffled<T, 0, 4, 2, 6>(rows[0], rows[1]), b = shuffled<T, 1, 5, 3, 7>(rows[0], rows[1]);
  out[0] = shuffled<T, 0, 1>(a, a);
  out[1] = shuffled<T, 0, 1>(b, b);
  out[2] = shuffled<T, 2, 3>(a, a);
  out[3] = shuffled<T, 2, 3>(b, b);
}
template <class T>
static DALEMBERT_INLINE void transpose_pair(const Lanes<T, 2>* rows, Lanes<T, 2>* out) {
  out[0] = shuffled<T, 0, 2>(rows[0], rows[1]);
  out[1] = shuffled<T, 1, 3>(rows[0], rows[1]);
}

// Steps of limbs that share a register: their slots follow one another, and where registers hold twice as many numbers as there
// are limbs that takes half the instructions, and of turning rows into columns a third. Not of short limbs: there the last step
// has been stored just before, and who reads two steps at once waits until both have reached the cache.
template <class T>
constexpr int together(int width, int steps) {
  const bool fits = (width == 4 || width == 2) && 2 * width <= doubles_in_register;
  return shuffles_in_registers && std::is_same_v<T, double> && fits && steps > 3 ? 2 : 1;
}

// Four steps of four limbs in two registers: turned[l] has limb l's.
template <class T>
static DALEMBERT_INLINE void turn_row(const Lanes<T, 8>* steps, Lanes<T, 4>* turned) {
  const Lanes<T, 8> first = shuffled<T, 0, 4, 8, 12, 1, 5, 9, 13>(steps[0], steps[1]);
  const Lanes<T, 8> last = shuffled<T, 2, 6, 10, 14, 3, 7, 11, 15>(steps[0], steps[1]);
  turned[0] = shuffled<T, 0, 1, 2, 3>(first, first);
  turned[1] = shuffled<T, 4, 5, 6, 7>(first, first);
  turned[2] = shuffled<T, 0, 1, 2, 3>(last, last);
  turned[3] = shuffled<T, 4, 5, 6, 7>(last, last);
}
// Four rows of two steps of four limbs: turned[l] has limb l's at the first step, turned[4 + l] at the second.
template <class T>
static DALEMBERT_INLINE void turn_columns(const Lanes<T, 8>& r0, const Lanes<T, 8>& r1, const Lanes<T, 8>& r2,
                                          const Lanes<T, 8>& r3, Lanes<T, 4>* turned) {
  using W = Lanes<T, 8>;
  const W a = shuffled<T, 0, 8, 2, 10, 4, 12, 6, 14>(r0, r1), b = shuffled<T, 1, 9, 3, 11, 5, 13, 7, 15>(r0, r1);
  const W c = shuffled<T, 0, 8, 2, 10, 4, 12, 6, 14>(r2, r3), d = shuffled<T, 1, 9, 3, 11, 5, 13, 7, 15>(r2, r3);
  const W both[4] = {shuffled<T, 0, 1, 8, 9, 4, 5, 12, 13>(a, c), shuffled<T, 0, 1, 8, 9, 4, 5, 12, 13>(b, d),
                     shuffled<T, 2, 3, 10, 11, 6, 7, 14, 15>(a, c), shuffled<T, 2, 3, 10, 11, 6, 7, 14, 15>(b, d)};
  lanes<4>([&](int l) DALEMBERT_IN_BLOCK {
    turned[l] = shuffled<T, 0, 1, 2, 3>(both[l], both[l]);
    turned[4 + l] = shuffled<T, 4, 5, 6, 7>(both[l], both[l]);
  });
}
// The same of two rows.
template <class T>
static DALEMBERT_INLINE void turn_columns(const Lanes<T, 8>& r0, const Lanes<T, 8>& r1, Lanes<T, 2>* turned) {
  using W = Lanes<T, 8>;
  const W a = shuffled<T, 0, 8, 2, 10, 4, 12, 6, 14>(r0, r1), b = shuffled<T, 1, 9, 3, 11, 5, 13, 7, 15>(r0, r1);
  turned[0] = shuffled<T, 0, 1>(a, a), turned[2] = shuffled<T, 2, 3>(a, a);
  turned[4] = shuffled<T, 4, 5>(a, a), turned[6] = shuffled<T, 6, 7>(a, a);
  turned[1] = shuffled<T, 0, 1>(b, b), turned[3] = shuffled<T, 2, 3>(b, b);
  turned[5] = shuffled<T, 4, 5>(b, b), turned[7] = shuffled<T, 6, 7>(b, b);
}

// The same of two limbs: four steps in two registers, …
template <class T>
static DALEMBERT_INLINE void turn_row(const Lanes<T, 4>* steps, Lanes<T, 4>* turned) {
  turned[0] = shuffled<T, 0, 2, 4, 6>(steps[0], steps[1]);
  turned[1] = shuffled<T, 1, 3, 5, 7>(steps[0], steps[1]);
}
// … four rows of two steps: turned[l] has limb l's at the first step, turned[2 + l] at the second, …
template <class T>
static DALEMBERT_INLINE void turn_columns(const Lanes<T, 4>& r0, const Lanes<T, 4>& r1, const Lanes<T, 4>& r2,
                                          const Lanes<T, 4>& r3, Lanes<T, 4>* turned) {
  const Lanes<T, 4> rows[4] = {r0, r1, r2, r3};
  transpose<T>(rows, turned);
}
// … and two rows.
template <class T>
static DALEMBERT_INLINE void turn_columns(const Lanes<T, 4>& r0, const Lanes<T, 4>& r1, Lanes<T, 2>* turned) {
  const Lanes<T, 4> rows[2] = {r0, r1};
  transpose_pair<T>(rows, turned);
}

template <class T>
static DALEMBERT_INLINE void store_count(T* to, const Lanes<T, 4>& x, int count) {
  if (count >= 4) {
    store<4, T>(to, x);
  } else if (count == 3) {
    if constexpr (stores_some<T, 4>) {
      store_some<4, T>(to, x, 3);
    } else {
      store<2, T>(to, shuffled<T, 0, 1>(x, x));
      to[2] = x[2];
    }
  } else if (count == 2) {
    store<2, T>(to, shuffled<T, 0, 1>(x, x));
  } else if (count == 1) {
    *to = x[0];
  }
}
template <class T>
static DALEMBERT_INLINE void store_count(T* to, const Lanes<T, 2>& x, int count) {
  if (count >= 2) store<2, T>(to, x);
  else if (count == 1) *to = x[0];
}

// The same of eight limbs: out[l] has limb l's.
template <class T>
static DALEMBERT_INLINE void transpose(const Lanes<T, 8>* rows, Lanes<T, 4>* out) {
  turn_columns<T>(rows[0], rows[1], rows[2], rows[3], out);
}
template <class T>
static DALEMBERT_INLINE void transpose_pair(const Lanes<T, 8>* rows, Lanes<T, 2>* out) {
  turn_columns<T>(rows[0], rows[1], out);
}

// A column of each lane's block: values of up to four consecutive rows, from to[lane] on. Where a lane is joined to the next,
// the next lane's rows follow its own: what is stored beyond its last row is overwritten.
template <int width, class T>
DALEMBERT_BLOCK void put_column(T* const* to, const Lanes<T, width>* values, const int* count, int along,
                                const bool* joined = nullptr) {
  if (along == 1) {
    lanes<width>([&](int l) DALEMBERT_IN_BLOCK {
      if (count[l] > 0) *to[l] = values[0][l];
    });
  } else if (along == 2) {
    Lanes<T, 2> turned[width];
    transpose_pair<T>(values, turned);
    lanes<width>([&](int l) DALEMBERT_IN_BLOCK {
      if (count[l] > 1) {
        store<2, T>(to[l], turned[l]);
      } else if (count[l] == 1) {
        *to[l] = turned[l][0];
      }
    });
  } else {
    const auto stored = [&](int l) DALEMBERT_IN_BLOCK {
      const bool whole = joined != nullptr && joined[l] && count[l] == 3 && count[l + 1] > 0;
      return whole ? 4 : count[l];
    };
    if constexpr (width == 2 && doubles_in_register * sizeof(double) < 4 * sizeof(T)) {
      // g++ turns four rows of registers of two by way of memory, and waits for it.
      Lanes<T, 2> first[2], last[2];
      transpose_pair<T>(values, first), transpose_pair<T>(values + 2, last);
      lanes<2>([&](int l) DALEMBERT_IN_BLOCK {
        store_count<T>(to[l], first[l], stored(l)), store_count<T>(to[l] + 2, last[l], stored(l) - 2);
      });
    } else {
      Lanes<T, 4> turned[width];
      transpose<T>(values, turned);
      lanes<width>([&](int l) DALEMBERT_IN_BLOCK { store_count<T>(to[l], turned[l], stored(l)); });
    }
  }
}

// Where up to four consecutive rows of a column of each lane's block go.
template <int width>
struct Line {
  int column[width], row[width], count[width];

  // Whether the next lane's rows follow three of a lane's in the same column. Where four are stored at a time and the lane has
  // three, a row of some other limb may stand between.
  constexpr bool joined(int l) const { return l + 1 < width && column[l + 1] == column[l] && row[l + 1] == row[l] + 3; }
};

// To a matrix, column by column, `leading` apart.
template <int width, class T>
DALEMBERT_BLOCK void put_line(T* matrix, int leading, const Line<width>& at, const Lanes<T, width>* values, int along) {
  T* to[width];
  bool joined[width];
  lanes<width>([&](int l) DALEMBERT_IN_BLOCK {
    to[l] = matrix + at.column[l] * leading + at.row[l];
    joined[l] = at.joined(l);
  });
  put_column<width, T>(to, values, at.count, along, joined);
}

// The same of columns already turned.
template <int width, class T>
DALEMBERT_BLOCK void put_turned(T* matrix, int leading, const Line<width>& at, const Lanes<T, 4>* turned) {
  lanes<width>([&](int l) DALEMBERT_IN_BLOCK {
    const bool whole = at.joined(l) && at.count[l] == 3 && at.count[l + 1] > 0;
    store_count<T>(matrix + at.column[l] * leading + at.row[l], turned[l], whole ? 4 : at.count[l]);
  });
}

// Where driven joints stand between others, rows go one by one.
template <int width, class T>
DALEMBERT_BLOCK void put_line(const Reduced<T>& matrix, int leading, const Line<width>& at, const Lanes<T, width>* values,
                              int along) {
  T* to[width] = {};
  int count[width] = {};
  lanes<width>([&](int l) DALEMBERT_IN_BLOCK {
    if (at.count[l] <= 0) return;
    const int column = matrix.coordinate[at.column[l]];
    const int* const row = matrix.coordinate + at.row[l];
    bool together = row[0] >= 0;
    lanes<3>([&](int j) DALEMBERT_IN_BLOCK {
      if (j + 1 < at.count[l]) together = together && row[j + 1] == row[0] + j + 1;
    });
    if (column < 0) {
      to[l] = matrix.driven_column(at.column[l]) + at.row[l];
      count[l] = at.count[l];
    } else if (together) {
      to[l] = matrix.matrix + column * leading + row[0];
      count[l] = at.count[l];
    } else {
      lanes<4>([&](int j) DALEMBERT_IN_BLOCK {
        if (j >= at.count[l]) return;
        *matrix.at(at.row[l] + j, at.column[l], leading) = lane<width, T>(values[j], l);
      });
    }
  });
  put_column<width, T>(to, values, count, along);
}

}  // namespace detail

}  // namespace dalembert
