// Blocks of rows and sums of columns in registers; inverses of symmetric matrices, with their pivots.
#pragma once

#include <dalembert/constraint_rows.hpp>
#include <dalembert/factor.hpp>

namespace dalembert {

namespace constraint_detail {

using detail::each_piece;
using detail::for_constants;

// m numbers padded to whole registers.
constexpr int rows_in_lanes(int m) { return (m + native_lanes - 1) / native_lanes * native_lanes; }
constexpr int lanes_in_block(int padded) { return least(native_lanes, padded); }

// Elements of J, one or several in lanes, but for those that are rounding. What is not a number stays so.
template <class T, class Numbers>
static DALEMBERT_INLINE Numbers without_rounding(const Numbers& x) {
  return x * x <= Numbers{} + Proximal<T>::unmoved * Proximal<T>::unmoved ? Numbers{} : x;
}

enum class Into { set, add };

// to[r][s] = the sum over k of a[k][r] b[k][s], as many rows of a block as say something; or this more or less. a and b:
// `count` times `padded` numbers.
template <int rows, int padded, Into how, class T>
static DALEMBERT_INLINE void products(const T* a, const T* b, int count, T* to) {
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
      for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { sum[r][i] += factor * row[i]; });
    });
  }
  for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { store<w, T>(to + r * padded + i * w, sum[r][i]); });
  });
}

// f(0), …, f(count - 1): with constants where they are few.
template <int count, bool constants = count <= 4, class F>
static DALEMBERT_INLINE void each_index(const F& f) {
  if constexpr (constants) {
    for_constants<count>(f);
  } else {
    for (int i = 0; i < count; ++i) f(i);
  }
}

// f(0), f(1), … for the coordinates above constraint c: with constants where they are few and c is one.
template <class Rows, class C, class F>
static DALEMBERT_INLINE void each_above(C c, const F& f) {
  if constexpr (std::is_same_v<C, int>) {
    for (int k = 0; k < Rows::lengths[c]; ++k) f(k);
  } else {
    each_index<Rows::lengths[C::value], (native_lanes >= 4 && Rows::lengths[C::value] <= 16)>(f);
  }
}

// The numbers of a block's row, in registers.
template <class T, int w, int pieces>
struct BlockRow {
  static constexpr int width = w, size = pieces;
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
  DALEMBERT_INLINE BlockRow minus(const BlockRow& a, const BlockRow& b) const {
    BlockRow row;
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { row.piece[i] = piece[i] - a.piece[i] * b.piece[i]; });
    return row;
  }
  DALEMBERT_INLINE BlockRow times(const BlockRow& a) const {
    BlockRow row;
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { row.piece[i] = piece[i] * a.piece[i]; });
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
  DALEMBERT_INLINE void subtract(const BlockRow& a) {
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { piece[i] -= a.piece[i]; });
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
  DALEMBERT_INLINE T total() const {
    Lanes<T, w> sum = piece[0];
    for_constants<pieces - 1>([&](auto i) DALEMBERT_IN_BLOCK { sum += piece[decltype(i)::value + 1]; });
    const auto of_four = [](const Lanes<T, 4>& x) DALEMBERT_IN_BLOCK {
      return (lane<4, T>(x, 0) + lane<4, T>(x, 2)) + (lane<4, T>(x, 1) + lane<4, T>(x, 3));
    };
    if constexpr (w == 8) {
      return of_four(detail::half<T, 0>(sum) + detail::half<T, 1>(sum));
    } else if constexpr (w == 4) {
      return of_four(sum);
    } else {
      T all = lane<w, T>(sum, 0);
      for_constants<w - 1>([&](auto i) DALEMBERT_IN_BLOCK { all += lane<w, T>(sum, decltype(i)::value + 1); });
      return all;
    }
  }
};

// How many of some rows say nothing new, and how little the least of them says, from the diagonal of (A + mu N)^-1: what is
// held of a row, mu N, times that is 1 along what no row moves and next to 0 along what rows move well, and the sum over all
// rows says how many directions are of the first kind, whatever the order of the rows.
template <class T>
struct Redundancy {
  T lost = T(0), most = T(0);  // sum and largest of held / (what is left of the row behind all others)
  DALEMBERT_INLINE void add(T share) {
    lost += share;
    most = share > most ? share : most;
  }
  // Of so many rows.
  DALEMBERT_INLINE void tell(int rows, ConstraintStatus<T>& status) const {
    status.rank = rows - (lost > T(0) ? static_cast<int>((lost < T(rows) ? lost : T(rows)) + T(0.5)) : 0);  // NaN: none
    if (most > Proximal<T>::mu) status.least_pivot = Proximal<T>::mu / most;
  }
};

// The same of rows in lanes.
template <class T, int w>
struct RedundancyInLanes {
  Lanes<T, w> lost{}, most{};
  DALEMBERT_INLINE void add(const Lanes<T, w>& share) {
    lost += share;
    most = share > most ? share : most;
  }
  DALEMBERT_INLINE Redundancy<T> of_all() const {
    Redundancy<T> all{BlockRow<T, w, 1>{{lost}}.total()};
    for_constants<w>([&](auto i) DALEMBERT_IN_BLOCK {
      const T share = lane<w, T>(most, i);
      all.most = share > all.most ? share : all.most;
    });
    return all;
  }
};
// The largest error of rows in lanes; none, where one is no number: a NaN's difference from itself is one.
template <class T, int w>
struct ErrorInLanes {
  Lanes<T, w> most{}, undefined{};
  DALEMBERT_INLINE void add(const Lanes<T, w>& error) {
    const Lanes<T, w> size = error < Lanes<T, w>{} ? -error : error;
    most = size > most ? size : most;
    undefined += error - error;
  }
  DALEMBERT_INLINE T of_all() const {
    T all = T(0);
    for_constants<w>([&](auto i) DALEMBERT_IN_BLOCK {
      const T size = lane<w, T>(most, i);
      all = size > all ? size : all;
    });
    return all + BlockRow<T, w, 1>{{undefined}}.total();
  }
};

// The sums of four rows' numbers.
template <class T, int w, int pieces>
static DALEMBERT_INLINE Lanes<T, 4> sums_of_four(const BlockRow<T, w, pieces>* rows) {
  if constexpr (w < 4 || !shuffles_in_registers) {
    return each_lane<4, T>([&](int i) DALEMBERT_IN_BLOCK { return rows[i].total(); });
  } else {
    const auto of_four = [&](int i) DALEMBERT_IN_BLOCK {
      Lanes<T, w> sum = rows[i].piece[0];
      for_constants<pieces - 1>([&](auto k) DALEMBERT_IN_BLOCK { sum += rows[i].piece[decltype(k)::value + 1]; });
      if constexpr (w == 8) return detail::half<T, 0>(sum) + detail::half<T, 1>(sum);
      else return sum;
    };
    const auto of_two = [&](int i) DALEMBERT_IN_BLOCK {
      const Lanes<T, 4> a = of_four(i), b = of_four(i + 1);
      return shuffled<T, 0, 4, 2, 6>(a, b) + shuffled<T, 1, 5, 3, 7>(a, b);
    };
    const Lanes<T, 4> a = of_two(0), b = of_two(2);
    return shuffled<T, 0, 1, 4, 5>(a, b) + shuffled<T, 2, 3, 6, 7>(a, b);
  }
}
template <class T, int w, int pieces>
static DALEMBERT_INLINE void totals_of_four(const BlockRow<T, w, pieces>* rows, T* to) {
  store<4, T>(to, sums_of_four(rows));
}

// A symmetric positive definite matrix of m rows becomes its inverse (Gauss and Jordan), pivot by pivot. Of what
// it was, elements on the diagonal and behind it are read; the others may be anything. A block of pivots inverted by itself
// would be wrong where rows say what others say: the inverse of a block that nearly is singular leaves nothing right of the
// rest, which is as small as mu. So two pivots follow each other, and rows are read and written once for both.
//
// Elements of a pivot's column are those of its row, with the other sign where they have been pivots themselves. Single numbers
// are written behind registers: what is read next has been there for long.
template <int m, int padded, class T>
static DALEMBERT_INLINE void invert_rows(T* a) {
  constexpr int w = native_lanes, pieces = padded / w;
  using Pieces = Lanes<T, w>[pieces];
  for (int j = 0; j + 1 < m; j += 2) {
    T *const own = a + j * padded, *const next = own + padded;
    const T beside = own[j + 1], reciprocal = T(1) / own[j], share = beside * reciprocal,
            second_reciprocal = T(1) / (next[j + 1] - beside * share), common = share * second_reciprocal;
    alignas(64) T was[padded], second_was[padded];
    Pieces first, second;
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      const Lanes<T, w> row = load<w>(own + i * w);
      first[i] = row * broadcast<w, T>(reciprocal);
      const Lanes<T, w> left = load<w>(next + i * w) - broadcast<w, T>(beside) * first[i];
      second[i] = left * broadcast<w, T>(second_reciprocal);
      store<w, T>(was + i * w, row), store<w, T>(second_was + i * w, left);
      store<w, T>(own + i * w, first[i] - broadcast<w, T>(share) * second[i]), store<w, T>(next + i * w, second[i]);
    });
    const auto subtract = [&](int r, T factor, T second_factor) DALEMBERT_IN_BLOCK {
      T* const row = a + r * padded;
      for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
        store<w, T>(row + i * w,
                    load<w>(row + i * w) - broadcast<w, T>(factor) * first[i] - broadcast<w, T>(second_factor) * second[i]);
      });
      row[j] = second_factor * common - factor * reciprocal;
      row[j + 1] = -second_factor * second_reciprocal;
    };
    for (int r = 0; r < j; ++r) subtract(r, -was[r], -second_was[r]);
    for (int r = j + 2; r < m; ++r) subtract(r, was[r], second_was[r]);
    own[j] = reciprocal + share * common;
    own[j + 1] = next[j] = -common;
    next[j + 1] = second_reciprocal;
  }
  if constexpr (m % 2 == 1) {  // the last alone
    constexpr int j = m - 1;
    T* const own = a + j * padded;
    const T reciprocal = T(1) / own[j];
    alignas(64) T was[padded];
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      const Lanes<T, w> row = load<w>(own + i * w);
      store<w, T>(was + i * w, row), store<w, T>(own + i * w, row * broadcast<w, T>(reciprocal));
    });
    for (int r = 0; r < j; ++r) {
      T* const row = a + r * padded;
      for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
        store<w, T>(row + i * w, load<w>(row + i * w) + broadcast<w, T>(was[r]) * load<w>(own + i * w));
      });
      row[j] = was[r] * reciprocal;
    }
    own[j] = reciprocal;
  }
}

// The same of few rows, which stay in registers, as far as there are some. Columns::of(r): where the diagonal's element of row
// r stands.
template <int m, int pieces, class Columns, class T>
struct RowsInRegisters {
  static constexpr int w = native_lanes, padded = w * pieces;
  using Row = BlockRow<T, w, pieces>;
  Row rows[m];

  DALEMBERT_INLINE void invert() {
    T pivot = element<0>(rows[0]);
    for_constants<m / 2>([&](auto pair) DALEMBERT_IN_BLOCK { pivot = invert_by_two<2 * decltype(pair)::value>(pivot); });
    if constexpr (m % 2 == 1) invert_by_last(pivot);
  }
  DALEMBERT_INLINE Row diagonal() const {
    Row all{};
    for_constants<m>([&](auto r) DALEMBERT_IN_BLOCK {
      constexpr int at = Columns::of(decltype(r)::value);
      all.piece[at / w] = with_lane_of<w, T, at % w>(all.piece[at / w], rows[r].piece[at / w]);
    });
    return all;
  }
  // Of what is symmetric.
  DALEMBERT_INLINE Row times(const Row& x) const {
    constexpr int sums = 4;
    Row sum[sums] = {};
    for_constants<m>([&](auto r) DALEMBERT_IN_BLOCK {
      constexpr int at = Columns::of(decltype(r)::value);
      const Lanes<T, w> factor = broadcast<w, T>(lane<w, T>(x.piece[at / w], at % w));
      for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { sum[r % sums].piece[i] += factor * rows[r].piece[i]; });
    });
    sum[0].add(sum[1]), sum[2].add(sum[3]), sum[0].add(sum[2]);
    return sum[0];
  }

 private:
  template <int r>
  static DALEMBERT_INLINE T element(const Row& row) {
    constexpr int at = Columns::of(r);
    return lane<w, T>(row.piece[at / w], at % w);
  }
  template <int r>
  static DALEMBERT_INLINE void set(Row& row, T x) {
    constexpr int at = Columns::of(r);
    row.piece[at / w] = with_lane_of<w, T, at % w>(row.piece[at / w], broadcast<w, T>(x));
  }
  template <int r, int s>
  static DALEMBERT_INLINE void clear(Row& row) {
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      constexpr int first = Columns::of(r) - decltype(i)::value * w, second = Columns::of(s) - decltype(i)::value * w;
      if constexpr ((first >= 0 && first < w) || (second >= 0 && second < w)) {
        const Lanes<T, w> none{}, stays = each_lane<w, T>([](int l) { return T(l == first || l == second ? 0 : 1); });
        row.piece[i] = stays > none ? row.piece[i] : none;
      }
    });
  }
  // Row r less, or more where it has been a pivot's before pivot j, `factor` times another.
  template <int r, int j>
  DALEMBERT_INLINE void subtract(const Lanes<T, w>& factor, const Row& from) {
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      if constexpr (r < j) rows[r].piece[i] += factor * from.piece[i];
      else rows[r].piece[i] -= factor * from.piece[i];
    });
  }

  // Two pivots, so that the rest is read and cleared once for both. Returns the next one, which is found before the rows: it is
  // what everything after it waits for.
  template <int j>
  DALEMBERT_INLINE T invert_by_two(T pivot) {
    const T reciprocal = T(1) / pivot, beside = element<j + 1>(rows[j]), share = beside * reciprocal,
            second_reciprocal = T(1) / (element<j + 1>(rows[j + 1]) - beside * share), common = share * second_reciprocal;
    Row first, left, second, own;
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      first.piece[i] = rows[j].piece[i] * broadcast<w, T>(reciprocal);
      left.piece[i] = rows[j + 1].piece[i] - broadcast<w, T>(beside) * first.piece[i];
      second.piece[i] = left.piece[i] * broadcast<w, T>(second_reciprocal);
      own.piece[i] = first.piece[i] - broadcast<w, T>(share) * second.piece[i];
    });
    T following = T(0);
    if constexpr (j + 2 < m) {
      constexpr int next = least(j + 2, m - 1);
      const T x = element<next>(rows[j]), y = element<next>(left);
      following = element<next>(rows[next]) - x * (x * reciprocal) - y * (y * second_reciprocal);
    }
    alignas(64) T was[padded], second_was[padded];
    rows[j].store(was), left.store(second_was);
    set<j>(first, reciprocal), set<j + 1>(first, T(0));
    set<j>(second, -common), set<j + 1>(second, second_reciprocal);
    for_constants<m>([&](auto of_r) DALEMBERT_IN_BLOCK {
      constexpr int r = decltype(of_r)::value;
      if constexpr (r != j && r != j + 1) {
        clear<j, j + 1>(rows[r]);
        subtract<r, j>(broadcast<w, T>(was[Columns::of(r)]), first);
        subtract<r, j>(broadcast<w, T>(second_was[Columns::of(r)]), second);
      }
    });
    set<j>(own, reciprocal + share * common), set<j + 1>(own, -common);
    rows[j] = own, rows[j + 1] = second;
    return following;
  }
  DALEMBERT_INLINE void invert_by_last(T pivot) {
    constexpr int j = m - 1;
    const T reciprocal = T(1) / pivot;
    alignas(64) T was[padded];
    rows[j].store(was);
    Row solved;
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { solved.piece[i] = rows[j].piece[i] * broadcast<w, T>(reciprocal); });
    set<j>(solved, reciprocal);
    for_constants<j>([&](auto r) DALEMBERT_IN_BLOCK {
      clear<j, j>(rows[r]);
      subtract<decltype(r)::value, j>(broadcast<w, T>(was[Columns::of(decltype(r)::value)]), solved);
    });
    rows[j] = solved;
  }
};

// The inverse of a symmetric matrix of few coordinates, A = L D L', of which the half below the diagonal is read and spoilt; of
// several in lanes. No number waits for more than it needs. Pivots follow each other: a block of them inverted by itself would
// leave nothing right of rows that say what others say.
template <int u, class T>
static DALEMBERT_INLINE void invert_few(T (&a)[u][u], T (&inverse)[u][u]) {
  T reciprocals[u], L[u][u], of_L[u][u];
  const auto behind = [](auto of_j, const auto& f) DALEMBERT_IN_BLOCK {
    constexpr int from = decltype(of_j)::value + 1;
    for_constants<u - from>([&](auto i) DALEMBERT_IN_BLOCK { f(std::integral_constant<int, from + decltype(i)::value>{}); });
  };
  for_constants<u>([&](auto j) DALEMBERT_IN_BLOCK {
    reciprocals[j] = (T{} + 1) / a[j][j];
    behind(j, [&](auto i) DALEMBERT_IN_BLOCK {
      L[i][j] = a[i][j] * reciprocals[j];
      behind(j, [&](auto k) DALEMBERT_IN_BLOCK {
        if (k <= i) a[i][k] -= L[i][j] * a[k][j];
      });
    });
  });
  for_constants<u>([&](auto j) DALEMBERT_IN_BLOCK {  // L^-1
    behind(j, [&](auto i) DALEMBERT_IN_BLOCK {
      T sum = L[i][j];
      behind(j, [&](auto k) DALEMBERT_IN_BLOCK {
        if (k < i) sum += L[i][k] * of_L[k][j];
      });
      of_L[i][j] = -sum;
    });
  });
  for_constants<u>([&](auto j) DALEMBERT_IN_BLOCK {
    for_constants<decltype(j)::value + 1>([&](auto i) DALEMBERT_IN_BLOCK {
      T sum = i == j ? reciprocals[j] : of_L[j][i] * reciprocals[j];
      behind(j, [&](auto k) DALEMBERT_IN_BLOCK { sum += of_L[k][i] * (reciprocals[k] * of_L[k][j]); });
      inverse[i][j] = sum;
      if (i != j) inverse[j][i] = sum;
    });
  });
}

// `columns` columns to(j) = base(j) more, or less, by the sum over k < count of factor(j, k) from(k): `pieces` registers of
// each from `begin` on. base: null where it is none.
template <int columns, int pieces, bool negative, class T, class Factor, class From, class Base, class To>
static DALEMBERT_INLINE void sum_tile(int begin, int count, const Factor& factor, const From& from, const Base& base,
                                      const To& to) {
  constexpr int w = native_lanes;
  Lanes<T, w> sum[columns][pieces];
  for_constants<columns>([&](auto j) DALEMBERT_IN_BLOCK {
    const T* const start = base(j);
    for_constants<pieces>([&](auto i)
                              DALEMBERT_IN_BLOCK { sum[j][i] = start ? load<w>(start + begin + i * w) : Lanes<T, w>{}; });
  });
  DALEMBERT_KEEP_LOOP
  for (int k = 0; k < count; ++k) {
    const T* const column = from(k) + begin;
    Lanes<T, w> x[pieces];
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      x[i] = load<w>(column + i * w);
      keep_in_register<T>(x[i]);
    });
    for_constants<columns>([&](auto j) DALEMBERT_IN_BLOCK {
      const Lanes<T, w> times = broadcast<w, T>(factor(j, k));
      for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
        if constexpr (negative) sum[j][i] -= times * x[i];
        else sum[j][i] += times * x[i];
      });
    });
  }
  for_constants<columns>([&](auto j) DALEMBERT_IN_BLOCK {
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { store<w, T>(to(j) + begin + i * w, sum[j][i]); });
  });
}

// The same of `size` numbers of each of them, whole registers.
template <int columns, int size, bool negative, class T, class Factor, class From, class Base, class To>
static DALEMBERT_INLINE void sum_columns(int count, const Factor& factor, const From& from, const Base& base, const To& to) {
  constexpr int w = native_lanes, all = (size + w - 1) / w, at_once = least(all, columns == 1 ? 8 : columns == 2 ? 4 : 2);
  constexpr int rest = all % at_once;
  int begin = 0;
  for (; begin + at_once * w <= all * w; begin += at_once * w)
    sum_tile<columns, at_once, negative, T>(begin, count, factor, from, base, to);
  if constexpr (rest > 0) sum_tile<columns, rest, negative, T>(begin, count, factor, from, base, to);
}

}  // namespace constraint_detail
}  // namespace dalembert
