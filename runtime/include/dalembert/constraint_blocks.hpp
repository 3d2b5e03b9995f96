// Blocks of rows in registers: their products, and inverses of small symmetric matrices, with their pivots.
#pragma once

#include <dalembert/constraint_rows.hpp>
#include <dalembert/factor.hpp>

namespace dalembert {

namespace constraint_detail {

using detail::each_piece;
using detail::for_constants;

constexpr int lanes_in_block(int padded) { return least(native_lanes, padded); }

enum class Into { set, add, subtract };

// to[r][s] = the sum over k of a[k][r] b[k][s], as many rows of a block as say something; or this more or less. a and b:
// `count` times `padded` numbers.
template <int rows, int padded, Into how, class T>
DALEMBERT_INLINE void products(const T* a, const T* b, int count, T* to) {
  constexpr int w = lanes_in_block(padded), pieces = padded / w;
  Lanes<T, w> sum[rows][pieces];
  for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      if constexpr (how == Into::set) sum[r][i] = Lanes<T, w>{};
      else sum[r][i] = load<w>(to + r * padded + i * w);
    });
  });
  DALEMBERT_KEEP_LOOP
  for (int k = 0; k < count; ++k) {
    Lanes<T, w> row[pieces];
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { row[i] = load<w>(b + k * padded + i * w); });
    for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
      const Lanes<T, w> factor = broadcast<w, T>(a[k * padded + r]);
      for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
        if constexpr (how == Into::subtract) sum[r][i] -= factor * row[i];
        else sum[r][i] += factor * row[i];
      });
    });
  }
  for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { store<w, T>(to + r * padded + i * w, sum[r][i]); });
  });
}

// f(0), …, f(count - 1): with constants where they are few.
template <int count, bool constants = count <= 4, class F>
DALEMBERT_INLINE void each_index(const F& f) {
  if constexpr (constants) {
    for_constants<count>(f);
  } else {
    for (int i = 0; i < count; ++i) f(i);
  }
}

// f(0), f(1), … for the coordinates above constraint c: with constants where they are few and c is one.
template <class Rows, class C, class F>
DALEMBERT_INLINE void each_above(C c, const F& f) {
  if constexpr (std::is_same_v<C, int>) {
    for (int k = 0; k < Rows::lengths[c]; ++k) f(k);
  } else {
    each_index<Rows::lengths[C::value], (native_lanes >= 4 && Rows::lengths[C::value] <= 16)>(f);
  }
}

// The numbers of a block's row, in registers.
template <class T, int w, int pieces>
struct BlockRow {
  Lanes<T, w> piece[pieces];

  static DALEMBERT_INLINE BlockRow load(const T* from) {
    BlockRow row;
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { row.piece[i] = dalembert::load<w>(from + i * w); });
    return row;
  }
  // f(0), f(1), …
  template <class F>
  static DALEMBERT_INLINE BlockRow of(const F& f) {
    BlockRow row;
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      row.piece[i] = each_lane<w, T>([&](int lane) { return f(decltype(i)::value * w + lane); });
    });
    return row;
  }
  DALEMBERT_INLINE void store(T* to) const {
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { dalembert::store<w, T>(to + i * w, piece[i]); });
  }
  // This and a b, element by element.
  DALEMBERT_INLINE BlockRow plus(const BlockRow& a, const BlockRow& b) const {
    BlockRow row;
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { row.piece[i] = piece[i] + a.piece[i] * b.piece[i]; });
    return row;
  }
  // This and lane i of a in that lane.
  template <class I>
  DALEMBERT_INLINE BlockRow with_only(const BlockRow& a, I) const {
    constexpr int at = I::value / w;
    BlockRow row = *this;
    row.piece[at] += a.piece[at] * each_lane<w, T>([](int lane) { return T(at * w + lane == I::value ? 1 : 0); });
    return row;
  }
  DALEMBERT_INLINE void add(const BlockRow& a) {
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { piece[i] += a.piece[i]; });
  }
  // More by a b[i], element by element.
  DALEMBERT_INLINE void add(const BlockRow& a, const T* b) {
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { piece[i] += a.piece[i] * dalembert::load<w>(b + i * w); });
  }
  // More by `times` row, or less.
  template <bool negative>
  DALEMBERT_INLINE void add(T times, const T* row) {
    const Lanes<T, w> factor = broadcast<w, T>(times);
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      if constexpr (negative) piece[i] -= factor * dalembert::load<w>(row + i * w);
      else piece[i] += factor * dalembert::load<w>(row + i * w);
    });
  }
  // More by the sum over r of x[r] a[r], or less: a's rows are as long as this.
  template <bool negative, int rows>
  DALEMBERT_INLINE void add_rows(const BlockRow& x, const T* a) {
    for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
      constexpr int at = decltype(r)::value;
      add<negative>(lane<w, T>(x.piece[at / w], at % w), a + at * pieces * w);
    });
  }
  // Less a x, row by row.
  template <int rows>
  DALEMBERT_INLINE void subtract_products(const BlockRow& x, const T* a) {
    alignas(64) T sums[pieces * w] = {};
    for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
      BlockRow product{};
      product.add(x, a + decltype(r)::value * pieces * w);
      sums[decltype(r)::value] = product.total();
    });
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { piece[i] -= dalembert::load<w>(sums + i * w); });
  }
  DALEMBERT_INLINE T total() const {
    Lanes<T, w> sum = piece[0];
    for_constants<pieces - 1>([&](auto i) DALEMBERT_IN_BLOCK { sum += piece[decltype(i)::value + 1]; });
    if constexpr (w == 4) return (lane<w, T>(sum, 0) + lane<w, T>(sum, 2)) + (lane<w, T>(sum, 1) + lane<w, T>(sum, 3));
    T all = lane<w, T>(sum, 0);
    for_constants<w - 1>([&](auto i) DALEMBERT_IN_BLOCK { all += lane<w, T>(sum, decltype(i)::value + 1); });
    return all;
  }
};

// The inverse of a symmetric positive definite matrix of three rows, (L D L')^-1, of which the upper half is read, row by row
// from `from` on, `stride` apart; its pivots are kept. Two of the three divisions go side by side: by the first pivot, and by
// the first times the second.
template <class T>
struct InverseOfThree {
  T of[3][3];

  DALEMBERT_INLINE InverseOfThree(const T* from, int stride, T* pivots) {
    const T a00 = from[0], a01 = from[1], a02 = from[2], a11 = from[stride + 1], a12 = from[stride + 2],
            a22 = from[2 * stride + 2];
    const T both = a00 * a11 - a01 * a01, r0 = T(1) / a00, r_both = T(1) / both, r1 = a00 * r_both;
    const T l10 = a01 * r0, l20 = a02 * r0, rest = a12 - l10 * a02, l21 = (a00 * a12 - a01 * a02) * r_both;
    const T d2 = a22 - a02 * l20 - rest * l21, r2 = T(1) / d2;
    pivots[0] = a00, pivots[1] = both * r0, pivots[2] = d2;
    const T m20 = l10 * l21 - l20, s20 = m20 * r2, s21 = -l21 * r2, s10 = -l10 * r1;  // of L^-1 and D^-1 L^-1
    of[0][0] = r0 - l10 * s10 + m20 * s20;
    of[1][1] = r1 - l21 * s21;
    of[2][2] = r2;
    of[0][1] = of[1][0] = s10 - l21 * s20;
    of[0][2] = of[2][0] = s20;
    of[1][2] = of[2][1] = s21;
  }
};

// A symmetric positive definite block becomes its inverse (Gauss and Jordan); its pivots are kept.
template <int rows, int padded, class T>
DALEMBERT_INLINE void invert_block(T* block, T* pivots) {
  constexpr int w = lanes_in_block(padded), pieces = padded / w;
  if constexpr (rows == 3) {
    const InverseOfThree<T> inverse(block, padded, pivots);
    for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
      for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
        constexpr int begin = decltype(i)::value * w;
        store<w, T>(block + r * padded + begin, each_lane<w, T>([&](int lane) {
                      return begin + lane < rows ? inverse.of[r][least(begin + lane, rows - 1)] : T(0);
                    }));
      });
    });
    return;
  }
  Lanes<T, w> a[rows][pieces];
  for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { a[r][i] = load<w>(block + r * padded + i * w); });
  });
  for_constants<rows>([&](auto step) DALEMBERT_IN_BLOCK {
    constexpr int j = decltype(step)::value, piece = j / w, at = j % w;
    const T pivot = lane<w, T>(a[j][piece], at), reciprocal = T(1) / pivot;
    pivots[j] = pivot;
    const Lanes<T, w> others = each_lane<w, T>([](int lane) { return T(lane != at); }),
                      own = each_lane<w, T>([](int lane) { return T(lane == at); });
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { a[j][i] *= broadcast<w, T>(reciprocal); });
    a[j][piece] = a[j][piece] * others + broadcast<w, T>(reciprocal) * own;
    for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
      if constexpr (decltype(r)::value != j) {
        const Lanes<T, w> factor = broadcast<w, T>(lane<w, T>(a[r][piece], at));
        a[r][piece] *= others;
        for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { a[r][i] -= factor * a[j][i]; });
      }
    });
  });
  for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { store<w, T>(block + r * padded + i * w, a[r][i]); });
  });
}

// Rows of `padded` numbers, where they are.
template <int padded, class T>
struct RowsInMemory {
  static constexpr int w = native_lanes, pieces = padded / w;
  static constexpr bool constants = false;          // whether rows are told apart when code is compiled
  static constexpr int column(int r) { return r; }  // of the diagonal
  T* const at;
  DALEMBERT_INLINE Lanes<T, w> get(int r, int i) const { return load<w>(at + r * padded + i * w); }
  DALEMBERT_INLINE void set(int r, int i, const Lanes<T, w>& x) const { store<w, T>(at + r * padded + i * w, x); }
};
// Rows that stay in registers, as far as there are some. Columns::of(r): where the diagonal's element of row r stands.
template <int m, int pieces_of_row, class Columns, class T>
struct RowsInRegisters {
  static constexpr int w = native_lanes, pieces = pieces_of_row;
  static constexpr bool constants = true;
  static constexpr int column(int r) { return Columns::of(r); }
  using Row = BlockRow<T, w, pieces>;
  Row rows[m];

  DALEMBERT_INLINE const Lanes<T, w>& get(int r, int i) const { return rows[r].piece[i]; }
  DALEMBERT_INLINE void set(int r, int i, const Lanes<T, w>& x) { rows[r].piece[i] = x; }
  // Of what is symmetric.
  DALEMBERT_INLINE Row times(const Row& x) const {
    constexpr int sums = 4;
    Row sum[sums] = {};
    for_constants<m>([&](auto r) DALEMBERT_IN_BLOCK {
      constexpr int at = column(decltype(r)::value);
      const Lanes<T, w> factor = broadcast<w, T>(lane<w, T>(x.piece[at / w], at % w));
      for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { sum[r % sums].piece[i] += factor * rows[r].piece[i]; });
    });
    sum[0].add(sum[1]), sum[2].add(sum[3]), sum[0].add(sum[2]);
    return sum[0];
  }
};
struct SameColumns {
  static constexpr int of(int r) { return r; }
};

// One step of invert_rows(), by the pivots `at` to `at + size - 1`, whose columns stand side by side.
template <int m, int at, int size, class T, class Matrix>
DALEMBERT_INLINE void invert_by(Matrix& a, T* pivots) {
  constexpr int w = Matrix::w, pieces = Matrix::pieces, padded = w * pieces, column = Matrix::column(at);
  alignas(64) T own[size * padded];
  for_constants<size>([&](auto s) DALEMBERT_IN_BLOCK {
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { store<w, T>(own + s * padded + i * w, a.get(at + s, i)); });
  });
  T inverse[size][size];
  static_assert(size == 1);
  pivots[at] = own[column];
  inverse[0][0] = T(1) / own[column];
  // What stands in the pivots' columns is replaced.
  const auto is_own = [](int k) { return k >= column && k < column + size; };
  const auto of_others = [&](auto i, const Lanes<T, w>& x) DALEMBERT_IN_BLOCK -> Lanes<T, w> {
    constexpr int begin = decltype(i)::value * w;
    if constexpr (begin + w <= column || begin >= column + size) return x;
    else return x * each_lane<w, T>([&](int lane) { return is_own(begin + lane) ? T(0) : T(1); });
  };
  Lanes<T, w> solved[size][pieces];
  for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
    constexpr int begin = decltype(i)::value * w;
    for_constants<size>([&](auto r) DALEMBERT_IN_BLOCK {
      Lanes<T, w> sum{};
      if constexpr (begin + w > column && begin < column + size)
        sum = each_lane<w, T>([&](int lane) {
          return is_own(begin + lane) ? inverse[r][is_own(begin + lane) ? begin + lane - column : 0] : T(0);
        });
      for_constants<size>([&](auto s)
                              DALEMBERT_IN_BLOCK { sum += broadcast<w, T>(inverse[r][s]) * of_others(i, a.get(at + s, i)); });
      solved[r][i] = sum;
    });
  });
  // Elements of the pivots' columns are those of their rows: with the other sign where they have been pivots themselves.
  const auto subtract = [&](auto before, int r) DALEMBERT_IN_BLOCK {
    Lanes<T, w> factor[size];
    for_constants<size>([&](auto s) DALEMBERT_IN_BLOCK { factor[s] = broadcast<w, T>(own[s * padded + Matrix::column(r)]); });
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      Lanes<T, w> sum = of_others(i, a.get(r, i));
      for_constants<size>([&](auto s) DALEMBERT_IN_BLOCK {
        if constexpr (decltype(before)::value) sum += factor[s] * solved[s][i];
        else sum -= factor[s] * solved[s][i];
      });
      a.set(r, i, sum);
    });
  };
  if constexpr (Matrix::constants) {
    for_constants<m - at - size>([&](auto r) DALEMBERT_IN_BLOCK { subtract(std::false_type{}, at + size + r); });
    for_constants<at>([&](auto r) DALEMBERT_IN_BLOCK { subtract(std::true_type{}, r); });
  } else {
    DALEMBERT_KEEP_LOOP
    for (int r = 0; r < at; ++r) subtract(std::true_type{}, r);
    DALEMBERT_KEEP_LOOP
    for (int r = at + size; r < m; ++r) subtract(std::false_type{}, r);
  }
  for_constants<size>([&](auto s) DALEMBERT_IN_BLOCK {
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { a.set(at + s, i, solved[s][i]); });
  });
}

// A symmetric positive definite matrix of m rows becomes its inverse (Gauss and Jordan), pivot by pivot, which are kept: this
// is the part of it that rows `first` to `first + count - 1` have, in order. Three at a time would be wrong where rows say what
// others say: an inverse of three rows that nearly are two leaves of the rest, which is as small as mu, nothing right. Of what
// the matrix was, elements on the diagonal and behind it are read; the others need only be numbers.
template <int m, int first, int count, class T, class Matrix>
DALEMBERT_INLINE void invert_rows(Matrix& a, T* pivots) {
  for_constants<count>([&](auto i) DALEMBERT_IN_BLOCK { invert_by<m, first + decltype(i)::value, 1>(a, pivots); });
}

}  // namespace constraint_detail
}  // namespace dalembert
