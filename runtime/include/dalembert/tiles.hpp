// Tiles of matrices of pairs: four joints by four, for as many limbs at once as there are lanes, filled with products of
// factors of the lower and of the upper joints and stored as columns (Shin, Park and Park 2016, eq. 31-39; see blocks.hpp).
//
// Every function is inlined into a block of blocks.hpp, whose sizes are constants: what depends on them alone costs nothing.
#pragma once

#include <initializer_list>
#include <type_traits>
#include <utility>

#include "dalembert/columns.hpp"
#include "dalembert/tile_shapes.hpp"

namespace dalembert {

// What the elements are made of: three components of a value of the joints, for all slots; component j of slot s stands at
// at[factor][j * stride + s].
template <class T, int n>
struct Factors {
  const T* at[n];
  int stride;
};

// Elements as sums of products of a lower factor and an upper one, by their numbers.
template <int lower, int upper>
struct Term {};
template <class... Terms>
struct Sum {};

// A matrix with the element (i, k) = Above and (k, i) = Below, i above k; the diagonal is Above's.
template <class AboveSum, class BelowSum>
struct Square {
  using Above = AboveSum;
  using Below = BelowSum;
};
// … with the element (k, i) = (i, k).
template <class AboveSum>
struct Symmetric {
  using Above = AboveSum;
};
// All that are filled together.
template <class... Kinds>
struct Matrices {
  static constexpr int count = sizeof...(Kinds);
};

// Limbs that stand side by side, `width` of them: which one is above each lane.
template <int width, int... lane>
struct LanesAbove {
  static constexpr int side_by_side = width;

  template <int n, int times, class T>
  DALEMBERT_INLINE static Lanes<T, n * times> read(const T* from) {
    // Of eight limbs the half that is read, where it is one.
    constexpr bool halves = width == 8 && (((lane < 4) && ...) || ((lane >= 4) && ...));
    constexpr int first = halves && ((lane >= 4) && ...) ? 4 : 0, some = halves ? 4 : width;
    const Lanes<T, some> x = load<some, T>(from + first);
    if constexpr (times == 1) return shuffled<T, (lane - first)...>(x, x);
    else return shuffled<T, (lane - first)..., (lane - first)...>(x, x);
  }

  // The same for some of the lanes, from one of them on.
  template <int from, int... i>
  static constexpr auto some_of(std::integer_sequence<int, i...>) {
    constexpr int all[] = {lane...};
    return LanesAbove<width, all[from + i]...>{};
  }
  template <int from, int count>
  using Some = decltype(some_of<from>(std::make_integer_sequence<int, count>{}));
};

namespace detail {

// f(0), …, f(count − 1), written out when `out` says so (count is then at most `most`, and known to the compiler).
template <bool out, int most, class F>
DALEMBERT_BLOCK void repeat(int count, const F& f) {
  if constexpr (out) {
    write_out(std::make_integer_sequence<int, most>{}, count, f);
  } else {
    for (int i = 0; i < count; ++i) f(i);
  }
}

// f(first, size) for tiles of four steps from begin to end, the last of them smaller where `steps` ends; written out when `out`
// says so (begin and end are then known to the compiler).
template <bool out, int steps, class F>
DALEMBERT_BLOCK void each_tile(int begin, int end, const F& f) {
  repeat<out, steps / 4>((end - begin) / 4,
                         [&](int i) DALEMBERT_IN_BLOCK { f(begin + 4 * i, std::integral_constant<int, 4>{}); });
  if constexpr (steps % 4 != 0)
    if (end == steps) f(steps / 4 * 4, std::integral_constant<int, steps % 4>{});
}

template <int n, class T>
DALEMBERT_INLINE void load_all(Lanes<T, n>* to, const T* from, int count, int stride) {
  for (int j = 0; j < count; ++j) to[j] = load<n, T>(from + j * stride);
}

// The factors of a limb's joints, from one of them on.
template <class T, int n>
struct Joints {
  const T* at[n];
  int stride;  // from component to component
  int step;    // from joint to joint

  Joints from(int joint) const {
    Joints moved = *this;
    for (int f = 0; f < n; ++f) moved.at[f] += joint * step;
    return moved;
  }
};

// How they stand there, read for `times` joints below at once. A limb above every lane, in the same order:
struct EachAbove {
  template <int, int>
  using Some = EachAbove;
  template <int n, int times, class T>
  DALEMBERT_INLINE static Lanes<T, n * times> read(const T* from) {
    if constexpr (times == 1) return load<n, T>(from);
    else return load_twice<n, T>(from);
  }
};
// One limb above all of them:
struct OneAbove {
  template <int, int>
  using Some = OneAbove;
  template <int n, int times, class T>
  DALEMBERT_INLINE static Lanes<T, n * times> read(const T* from) {
    return broadcast<n * times, T>(*from);
  }
};
// Up to four joints above by as many below, for `lanes` limbs at once, of `pack` joints below in a register: [above][below].
template <int limbs, int below, int packed, class T>
struct Tile {
  using Number = T;
  static constexpr int width = limbs, columns = below, pack = below > 1 ? packed : 1, groups = (columns + pack - 1) / pack;
  Lanes<T, width * pack> at[4][groups];

  DALEMBERT_INLINE Lanes<T, width> operator()(int r, int c) const {
    if constexpr (pack == 1) return at[r][c];
    else if (c % 2 == 0) return part<0>(at[r][c / 2], std::make_integer_sequence<int, width>{});
    else return part<width>(at[r][c / 2], std::make_integer_sequence<int, width>{});
  }

 private:
  template <int from, int... lane>
  DALEMBERT_INLINE static Lanes<T, width> part(const Lanes<T, width * pack>& x, std::integer_sequence<int, lane...>) {
    return shuffled<T, (from + lane)...>(x, x);
  }
};

// What is wanted of a tile: all of it, or its upper triangle, with the diagonal or without.
enum class Part { all, upper, strictly_upper };
constexpr bool wanted(Part part, int r, int c) { return part == Part::all || r < c || (part == Part::upper && r == c); }
// … of joints below that share a register: whether any is.
template <int pack, int columns>
constexpr bool wanted_group(Part part, int r, int g) {
  return wanted(part, r, least(g * pack + pack, columns) - 1);
}

// One component's products: tile[r][c] = or += below[c] · above[r]. Every value is read once, and the tile stays in registers.
template <bool set, Part part, class Standing, int rows, class Filled, class T>
DALEMBERT_BLOCK void component(Filled& tile, const T* below, int below_step, const T* above, int above_step) {
  constexpr int width = Filled::width, columns = Filled::columns, pack = Filled::pack, groups = Filled::groups,
                n = width * pack;
  Lanes<T, n> b[groups];
  lanes<groups>([&](int g) DALEMBERT_IN_BLOCK { b[g] = load<n, T>(below + g * pack * below_step); });
  lanes<rows>([&](int r) DALEMBERT_IN_BLOCK {
    const Lanes<T, n> a = Standing::template read<width, pack, T>(above + r * above_step);
    lanes<groups>([&](int g) DALEMBERT_IN_BLOCK {
      if (!wanted_group<pack, columns>(part, r, g)) return;
      if (set) tile.at[r][g] = b[g] * a;
      else tile.at[r][g] += b[g] * a;
    });
  });
}

// tile[r][c] = or += Σ_j below[j][c] · above[j][r], component by component, three of them.
template <bool from_zero, Part part, class Standing, int rows, class Filled, class T>
DALEMBERT_BLOCK void products(Filled& tile, const T* below, int below_step, int below_stride, const T* above, int above_step,
                              int above_stride) {
  lanes<3>([&](int j) DALEMBERT_IN_BLOCK {
    const T *from_below = below + j * below_stride, *from_above = above + j * above_stride;
    if (from_zero && j == 0) component<true, part, Standing, rows>(tile, from_below, below_step, from_above, above_step);
    else component<false, part, Standing, rows>(tile, from_below, below_step, from_above, above_step);
  });
}

// The same as a loop that no compiler unrolls: less code. It starts from zeros.
template <bool from_zero, Part part, class Standing, int rows, class Filled, class T>
DALEMBERT_BLOCK void products_in_loop(Filled& tile, const T* below, int below_step, int below_stride, const T* above,
                                      int above_step, int above_stride) {
  if constexpr (from_zero)
    lanes<rows>([&](int r) DALEMBERT_IN_BLOCK {
      lanes<Filled::groups>([&](int g) DALEMBERT_IN_BLOCK {
        if (wanted_group<Filled::pack, Filled::columns>(part, r, g)) tile.at[r][g] = Lanes<T, Filled::width * Filled::pack>{};
      });
    });
  DALEMBERT_KEEP_LOOP
  for (int j = 0; j < 3; ++j)
    component<false, part, Standing, rows>(tile, below + j * below_stride, below_step, above + j * above_stride, above_step);
}

// Products of `rows` joints above with `columns` below.
template <bool loop, Part part, class Standing, int rows, class Filled>
struct Products {
  using T = typename Filled::Number;
  int below_step, below_stride, above_step, above_stride;

  // The sum of the terms, factor by factor.
  template <int nl, int nu, int lower, int upper, class... Rest>
  DALEMBERT_INLINE void fill(Filled& tile, const Joints<T, nl>& below, const Joints<T, nu>& above,
                             Sum<Term<lower, upper>, Rest...>) const {
    sum<true>(tile, below.at[lower], above.at[upper]);
    add(tile, below, above, Sum<Rest...>{});
  }

 private:
  template <int nl, int nu>
  DALEMBERT_INLINE void add(Filled&, const Joints<T, nl>&, const Joints<T, nu>&, Sum<>) const {}
  template <int nl, int nu, int lower, int upper, class... Rest>
  DALEMBERT_INLINE void add(Filled& tile, const Joints<T, nl>& below, const Joints<T, nu>& above,
                            Sum<Term<lower, upper>, Rest...>) const {
    sum<false>(tile, below.at[lower], above.at[upper]);
    add(tile, below, above, Sum<Rest...>{});
  }

  template <bool from_zero>
  DALEMBERT_INLINE void sum(Filled& tile, const T* below, const T* above) const {
    if constexpr (loop)
      products_in_loop<from_zero, part, Standing, rows>(tile, below, below_step, below_stride, above, above_step, above_stride);
    else products<from_zero, part, Standing, rows>(tile, below, below_step, below_stride, above, above_step, above_stride);
  }
};

// Halves of two registers in one.
template <class V, int... lane>
DALEMBERT_INLINE V first_halves(const V& x, const V& y, std::integer_sequence<int, lane...>) {
  constexpr int n = sizeof...(lane);
  return shuffled<std::decay_t<decltype(x[0])>, lane..., (2 * n + lane)...>(x, y);
}
template <class V, int... lane>
DALEMBERT_INLINE V second_halves(const V& x, const V& y, std::integer_sequence<int, lane...>) {
  constexpr int n = sizeof...(lane);
  return shuffled<std::decay_t<decltype(x[0])>, (n + lane)..., (3 * n + lane)...>(x, y);
}

// What stands below a tile's diagonal, from another's above it, rows and columns exchanged.
template <class Filled>
DALEMBERT_BLOCK void mirror(Filled& tile, const Filled& below) {
  constexpr int width = Filled::width, columns = Filled::columns, pack = Filled::pack;
  lanes<columns>([&](int r) DALEMBERT_IN_BLOCK {
    if constexpr (pack == 1) {
      lanes<columns>([&](int c) DALEMBERT_IN_BLOCK {
        if (c < r) tile.at[r][c] = below.at[c][r];
      });
    } else {  // joint r shares its register with r + 1 or r − 1
      lanes<columns / 2>([&](int g) DALEMBERT_IN_BLOCK {
        constexpr std::make_integer_sequence<int, width> each{};
        const int c = 2 * g;
        if (r <= c) return;
        if (r % 2 == 0) tile.at[r][g] = first_halves(below.at[c][r / 2], below.at[c + 1][r / 2], each);
        else if (r > c + 1) tile.at[r][g] = second_halves(below.at[c][r / 2], below.at[c + 1][r / 2], each);
        else tile.at[r][g] = second_halves(below.at[c][g], tile.at[r][g], each);
      });
    }
  });
}

// A tile's place in M or C, lane by lane: first rows, and how many real steps there are from there on.
template <int width>
struct Place {
  int row_above[width], left_above[width], row_below[width], left_below[width];
};

// Whether a tile is stored a register at a time, without taking its limbs apart first.
template <class From, class To>
constexpr bool turns_packed = false;
template <int width, int columns, int pack, class T>
constexpr bool turns_packed<Tile<width, columns, pack, T>, T*> = Tile<width, columns, pack, T>::pack == 2;

// Stores tile[above][below] as columns of the lower limb's joints (rows run over `above`), or of the upper limb's.
template <bool by_upper, int rows, int columns, int width, class T, class From, class To>
DALEMBERT_BLOCK void put(const To& matrix, int leading, const From& tile, const Place<width>& at) {
  constexpr int lines = by_upper ? rows : columns, along = by_upper ? columns : rows;
  const auto place_of = [&](int line) DALEMBERT_IN_BLOCK {
    const int* left = by_upper ? at.left_below : at.left_above;
    const int* across = by_upper ? at.left_above : at.left_below;
    Line<width> where;
    lanes<width>([&](int l) DALEMBERT_IN_BLOCK {
      where.column[l] = (by_upper ? at.row_above : at.row_below)[l] + line;
      where.row[l] = (by_upper ? at.row_below : at.row_above)[l];
      where.count[l] = line < across[l] ? least(left[l], along) : 0;
    });
    return where;
  };
  if constexpr (turns_packed<From, To> && along > 2) {
    constexpr int each = by_upper ? 1 : 2;
    lanes<(lines + each - 1) / each>([&](int i) DALEMBERT_IN_BLOCK {
      Lanes<T, 4> turned[width * each];
      if constexpr (by_upper) turn_row<T>(tile.at[i], turned);
      else turn_columns<T>(tile.at[0][i], tile.at[1][i], tile.at[2][i], tile.at[rows - 1][i], turned);
      lanes<each>([&](int n) DALEMBERT_IN_BLOCK {
        if (each * i + n < lines) put_turned<width, T>(matrix, leading, place_of(each * i + n), turned + width * n);
      });
    });
  } else {
    lanes<lines>([&](int i) DALEMBERT_IN_BLOCK {
      Lanes<T, width> line[4] = {};
      lanes<along>([&](int j) DALEMBERT_IN_BLOCK { line[j] = by_upper ? tile(i, j) : tile(j, i); });
      put_line<width, T>(matrix, leading, place_of(i), line, along);
    });
  }
}

// Both triangles of an off-diagonal tile of `rows` joints above by `columns` below, or the whole of a diagonal one.
template <bool out, class Standing, int width, int rows, int columns, int pack, bool diagonal, class T, int nl, int nu,
          class AboveSum, class To>
DALEMBERT_BLOCK void tile_of(Symmetric<AboveSum>, const Joints<T, nl>& lower, const Joints<T, nu>& up, const Place<width>& at,
                             const To& matrix, int leading) {
  using Filled = Tile<width, columns, pack, T>;
  constexpr bool loop = products_loop(out, rows, columns, diagonal);
  const Products<loop, diagonal ? Part::upper : Part::all, Standing, rows, Filled> products{lower.step, lower.stride, up.step,
                                                                                            up.stride};
  Filled m;
  products.fill(m, lower, up, AboveSum{});
  if constexpr (diagonal) {
    mirror(m, m);
    put<false, rows, columns, width, T>(matrix, leading, m, at);
  } else {
    put<false, rows, columns, width, T>(matrix, leading, m, at);
    put<true, rows, columns, width, T>(matrix, leading, m, at);
  }
}
template <bool out, class Standing, int width, int rows, int columns, int pack, bool diagonal, class T, int nl, int nu,
          class AboveSum, class BelowSum, class To>
DALEMBERT_BLOCK void tile_of(Square<AboveSum, BelowSum>, const Joints<T, nl>& lower, const Joints<T, nu>& up,
                             const Place<width>& at, const To& matrix, int leading) {
  using Filled = Tile<width, columns, pack, T>;
  constexpr bool loop = products_loop(out, rows, columns, diagonal);
  const Products<loop, diagonal ? Part::upper : Part::all, Standing, rows, Filled> products{lower.step, lower.stride, up.step,
                                                                                            up.stride};
  const Products<loop, diagonal ? Part::strictly_upper : Part::all, Standing, rows, Filled> others{lower.step, lower.stride,
                                                                                                   up.step, up.stride};
  Filled above;  // element (i, k)
  products.fill(above, lower, up, AboveSum{});
  if constexpr (!diagonal) put<false, rows, columns, width, T>(matrix, leading, above, at);
  Filled below;  // element (k, i)
  others.fill(below, lower, up, BelowSum{});
  if constexpr (diagonal) {
    mirror(above, below);
    put<false, rows, columns, width, T>(matrix, leading, above, at);
  } else {
    put<true, rows, columns, width, T>(matrix, leading, below, at);
  }
}

// The same tile of every matrix.
template <bool out, class Standing, int width, int rows, int columns, int pack, bool diagonal, class T, int nl, int nu,
          class To, class... Kinds>
DALEMBERT_BLOCK void tiles_of(Matrices<Kinds...>, const Joints<T, nl>& lower, const Joints<T, nu>& up, const Place<width>& at,
                              const To* matrices, int leading) {
  int m = 0;
  (void)std::initializer_list<int>{
      (tile_of<out, Standing, width, rows, columns, pack, diagonal, T>(Kinds{}, lower, up, at, matrices[m++], leading), 0)...};
}

}  // namespace detail

}  // namespace dalembert
