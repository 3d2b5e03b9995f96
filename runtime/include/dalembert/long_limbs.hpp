// Phase III of long limbs: lanes run along a limb's joints, down a column of M and C, wherever the limb's slots are. See
// blocks.hpp for the equations.
//
// A limb's factors exceed the first-level cache, and the matrices the second. So the rows of a block are taken tile by tile,
// whose factors stay in the first-level cache for all columns; one pass over them fills all matrices and as many columns as
// registers allow.
#pragma once

#include "dalembert/runs.hpp"

namespace dalembert {

// Joints one below the other: where their slots are, step apart, and their rows of the matrices. length 0: none.
struct LongLimb {
  int first_slot, step, first_row, length;
};

namespace detail {

// Columns that are filled together: of 32 registers two columns' factors leave room for their sums.
inline constexpr int columns_together = doubles_in_register == 8 ? 2 : 1;

// The factors of up to long_limb_tile joints of a limb, one joint beside the other: where they stand so already, there; else
// copied, of which those of [begin, end) are asked for.
template <class T, int n>
class TileOfFactors {
 public:
  DALEMBERT_BLOCK Factors<T, n> of(const Factors<T, n>& p, const LongLimb& limb, int first, int begin, int end,
                                   TileOfFactors& room) {
    if (limb.step == 1) return moved(p, limb.first_slot + first);
    for (int f = 0; f < n; ++f)
      for (int j = 0; j < 3; ++j) {
        const T* const from = p.at[f] + j * p.stride + limb.first_slot + first * limb.step;
        T* const to = room.row(f, j);
        for (int i = begin; i < end; ++i) to[i] = from[i * limb.step];
        for (int i = end; i < least(end + run_lanes, long_limb_tile); ++i) to[i] = 0;  // what a short run's register reads
      }
    Factors<T, n> all{{}, long_limb_tile};
    for (int f = 0; f < n; ++f) all.at[f] = room.row(f, 0);
    return all;
  }

 private:
  T* row(int f, int j) { return at_ + (3 * f + j) * long_limb_tile; }

  alignas(64) T at_[3 * n * long_limb_tile + run_lanes];  // a short run's register reads behind the last row
};

// A term of a sum, by number.
template <int number, class Terms>
struct TermOf {
  static constexpr bool there = false;
};
template <int number, int l, int u, class... Rest>
struct TermOf<number, Sum<Term<l, u>, Rest...>> : TermOf<number - 1, Sum<Rest...>> {};
template <int l, int u, class... Rest>
struct TermOf<0, Sum<Term<l, u>, Rest...>> {
  static constexpr bool there = true;
  static constexpr int lower = l, upper = u;
};

// The elements of columns of joints below, along joints above them: a number of the column's joint, times numbers above.
struct Above {
  template <class Kind>
  using Terms = typename Kind::Above;
  template <class Term>
  static constexpr int single = Term::lower;
  template <class Term>
  static constexpr int along = Term::upper;
};
// … of columns of joints above, along joints below them.
struct Below {
  template <class Kind>
  using Terms = decltype(below_of(Kind{}));
  template <class Term>
  static constexpr int single = Term::upper;
  template <class Term>
  static constexpr int along = Term::lower;
};

// Component j of term `number`, of one matrix in all columns.
template <class Side, class Kind, int number, int w, int columns, class T, int n, class Vectors>
DALEMBERT_BLOCK void add_component(Lanes<T, w>* sums, const Single<T, n>* single, const Vectors& along, int s, int j) {
  using Term = TermOf<number, typename Side::template Terms<Kind>>;
  if constexpr (Term::there) {
    Lanes<T, w> x = load<w, T>(along.at[Side::template along<Term>] + j * along.stride + s);
    keep_in_register<T>(x);
    lanes<columns>([&](int c) DALEMBERT_IN_BLOCK {
      const T factor = single[c].at[Side::template single<Term>][j];
      if (number == 0 && j == 0) sums[c] = factor * x;
      else sums[c] += factor * x;
    });
  }
}

// The elements at rows s, s + 1, … of all matrices. Matrices side by side, component by component: what they have in common is
// read once, and the columns' own numbers leave registers for no more.
template <class Side, int number, int w, int columns, class T, int n, class Vectors, class... Kinds>
DALEMBERT_BLOCK void add_terms(Matrices<Kinds...>, Lanes<T, w>* sums, const Single<T, n>* single, const Vectors& along, int s) {
  if constexpr ((TermOf<number, typename Side::template Terms<Kinds>>::there || ...)) {
    lanes<3>([&](int j) DALEMBERT_IN_BLOCK {
      Lanes<T, w>* to = sums;
      ((add_component<Side, Kinds, number, w, columns, T>(to, single, along, s, j), to += columns), ...);
    });
    add_terms<Side, number + 1, w, columns, T>(Matrices<Kinds...>{}, sums, single, along, s);
  }
}

// Rows s, s + 1, … of columns of all matrices; to: per matrix and column.
template <class Side, int w, int columns, class T, int n, class Vectors, class... Kinds>
DALEMBERT_BLOCK void fill_at(Matrices<Kinds...> kinds, T* const* to, int s, int count, const Single<T, n>* single,
                             const Vectors& along) {
  Lanes<T, w> sums[sizeof...(Kinds) * columns];
  add_terms<Side, 0, w, columns, T>(kinds, sums, single, along, s);
  // Behind all sums: what is read could stand where it is written, for all that a compiler knows.
  lanes<sizeof...(Kinds) * columns>([&](int i) DALEMBERT_IN_BLOCK {
    if (count >= w) store<w, T>(to[i] + s, sums[i]);
    else store_some<w, T>(to[i] + s, sums[i], count);
  });
}
template <class Side, int w, int columns, class T, int n, class Vectors, class Kinds>
DALEMBERT_BLOCK void fill_by(Kinds kinds, T* const* to, int count, const Single<T, n>* single, const Vectors& along) {
  int s = 0;
  for (; s + w <= count; s += w) fill_at<Side, w, columns, T>(kinds, to, s, w, single, along);
  if (s == count) return;
  if (count >= w) fill_at<Side, w, columns, T>(kinds, to, count - w, w, single, along);  // overlaps the one before
  else fill_at<Side, w, columns, T>(kinds, to, s, count - s, single, along);
}
template <class Side, int columns, class T, int n, class Vectors, class Kinds>
DALEMBERT_BLOCK void fill(Kinds kinds, T* const* to, int count, const Single<T, n>* single, const Vectors& along) {
  if constexpr (native_lanes > run_lanes)
    if (count >= native_lanes) return fill_by<Side, native_lanes, columns, T>(kinds, to, count, single, along);
  fill_by<Side, run_lanes, columns, T>(kinds, to, count, single, along);
}

// Where column `column` of each matrix has row `row`, and the same of the columns behind it.
template <int kinds, int columns, class T>
struct Columns {
  T* at[kinds * columns];

  Columns(T* const* matrices, int leading, int column, int row) {
    for (int m = 0; m < kinds; ++m)
      for (int c = 0; c < columns; ++c) at[m * columns + c] = matrices[m] + (column + c) * leading + row;
  }
};

template <class T, int n, int columns>
struct Singles {
  Single<T, n> of[columns];
};
template <int columns, class T, int n>
DALEMBERT_BLOCK Singles<T, n, columns> singles(const Factors<T, n>& p, const LongLimb& limb, int joint) {
  const int slot = limb.first_slot + joint * limb.step;
  if constexpr (columns == 1) return {{Single<T, n>(p.at, p.stride, slot)}};
  else return {{Single<T, n>(p.at, p.stride, slot), Single<T, n>(p.at, p.stride, slot + limb.step)}};
}

// Columns of joints k, k + 1, … of a limb over `rows` joints above them.
template <int columns, class T, int nl, int nu, class... Kinds>
DALEMBERT_BLOCK void columns_above(Matrices<Kinds...> kinds, const Factors<T, nl>& lower, const LongLimb& limb, int k,
                                   const Factors<T, nu>& up, int rows, T* const* matrices, int leading, int row) {
  const Singles<T, nl, columns> single = singles<columns>(lower, limb, k);
  const Columns<sizeof...(Kinds), columns, T> to(matrices, leading, limb.first_row + k, row);
  fill<Above, columns, T>(kinds, to.at, rows, single.of, up);
}

// Columns of joints i, i + 1, … of a limb over `rows` joints below them.
template <int columns, class T, int nl, int nu, class... Kinds>
DALEMBERT_BLOCK void columns_below(Matrices<Kinds...> kinds, const Factors<T, nl>& low, int rows, const Factors<T, nu>& upper,
                                   const LongLimb& limb, int i, T* const* matrices, int leading, int row) {
  const Singles<T, nu, columns> single = singles<columns>(upper, limb, i);
  const Columns<sizeof...(Kinds), columns, T> to(matrices, leading, limb.first_row + i, row);
  fill<Below, columns, T>(kinds, to.at, rows, single.of, low);
}

// f(how many, first) for columns [begin, end).
template <int together, class F>
DALEMBERT_BLOCK void each_columns(int begin, int end, const F& f) {
  int k = begin;
  for (; k + together <= end; k += together) f(std::integral_constant<int, together>{}, k);
  if constexpr (together > 1)
    for (; k < end; ++k) f(std::integral_constant<int, 1>{}, k);
}

// The block of a limb with itself; columns [begin, end).
template <class Kinds, int together, class T, int nl, int nu>
DALEMBERT_BLOCK void own_block(const Factors<T, nl>& lower, const Factors<T, nu>& upper, const LongLimb& limb,
                               T* const* matrices, int leading, int begin, int end) {
  TileOfFactors<T, nu> room_up;
  TileOfFactors<T, nl> room_low;
  for (int first = 0; first < limb.length; first += long_limb_tile) {
    const int rows = least(long_limb_tile, limb.length - first), last = first + rows;
    Factors<T, nu> up{};
    Factors<T, nl> low{};
    if (end > first) up = TileOfFactors<T, nu>::of(upper, limb, first, 0, least(rows, end - first), room_up);
    if (begin < last) low = TileOfFactors<T, nl>::of(lower, limb, first, begin > first ? begin - first : 0, rows, room_low);
    each_columns<together>(begin, end, [&](auto some, int k) DALEMBERT_IN_BLOCK {
      constexpr int columns = decltype(some)::value;
      const int above = least(rows, k + columns - first), below = k + columns > first ? k + columns : first;
      if (above > 0) columns_above<columns, T>(Kinds{}, lower, limb, k, up, above, matrices, leading, limb.first_row + first);
      if (below < last)
        columns_below<columns, T>(Kinds{}, moved(low, below - first), last - below, upper, limb, k, matrices, leading,
                                  limb.first_row + below);
      // Of two columns the first one's last row above is below its joint.
      if (columns > 1 && k + 1 >= first && k + 1 < last)
        columns_below<1, T>(Kinds{}, moved(low, k + 1 - first), 1, upper, limb, k, matrices, leading, limb.first_row + k + 1);
    });
  }
}

// The blocks between a limb and one above it; columns and rows [begin, end) of the lower one.
template <class Kinds, int together, class T, int nl, int nu>
DALEMBERT_BLOCK void block_with(const Factors<T, nl>& lower, const Factors<T, nu>& upper, const LongLimb& limb,
                                const LongLimb& above, T* const* matrices, int leading, int begin, int end) {
  TileOfFactors<T, nu> room_up;
  for (int first = 0; first < above.length; first += long_limb_tile) {
    const int rows = least(long_limb_tile, above.length - first);
    const Factors<T, nu> up = TileOfFactors<T, nu>::of(upper, above, first, 0, rows, room_up);
    each_columns<together>(begin, end, [&](auto some, int k) DALEMBERT_IN_BLOCK {
      columns_above<decltype(some)::value, T>(Kinds{}, lower, limb, k, up, rows, matrices, leading, above.first_row + first);
    });
  }
  TileOfFactors<T, nl> room_low;
  for (int first = begin; first < end; first += long_limb_tile) {
    const int rows = least(long_limb_tile, end - first);
    const Factors<T, nl> low = TileOfFactors<T, nl>::of(lower, limb, first, 0, rows, room_low);
    each_columns<together>(0, above.length, [&](auto some, int i) DALEMBERT_IN_BLOCK {
      columns_below<decltype(some)::value, T>(Kinds{}, low, rows, upper, above, i, matrices, leading, limb.first_row + first);
    });
  }
}

// f(limb, begin, end) for those of the joints [begin, end), counted through all limbs, that are the limb's.
template <class F>
DALEMBERT_BLOCK void each_limb(const LongLimb* limbs, int count, int begin, int end, const F& f) {
  for (int l = 0; l < count; ++l) {
    const int from = begin > 0 ? begin : 0, to = least(end, limbs[l].length);
    if (from < to) f(l, from, to);
    begin -= limbs[l].length, end -= limbs[l].length;
  }
}

}  // namespace detail

// The block of every limb with itself; columns of the joints [begin, end), counted through all limbs one after another.
template <class Kinds, class T, int together = detail::columns_together, int nl, int nu>
static void long_limb_blocks(const Factors<T, nl>& lower, const Factors<T, nu>& upper, const LongLimb* limbs, int count,
                             T* const* matrices, int leading, int begin, int end) {
  detail::each_limb(limbs, count, begin, end, [&](int l, int from, int to) DALEMBERT_IN_BLOCK {
    detail::own_block<Kinds, together>(lower, upper, limbs[l], matrices, leading, from, to);
  });
}

// The blocks between every limb and one above it, above[0…count).
template <class Kinds, class T, int together = detail::columns_together, int nl, int nu>
static void long_limb_cross_blocks(const Factors<T, nl>& lower, const Factors<T, nu>& upper, const LongLimb* limbs,
                                   const LongLimb* above, int count, T* const* matrices, int leading, int begin, int end) {
  detail::each_limb(limbs, count, begin, end, [&](int l, int from, int to) DALEMBERT_IN_BLOCK {
    detail::block_with<Kinds, together>(lower, upper, limbs[l], above[l], matrices, leading, from, to);
  });
}

}  // namespace dalembert
