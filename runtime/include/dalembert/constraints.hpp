// Accelerations that keep to constraints: M dv = e + J' f, J dv = b, with M's factors along the tree, M = U D U' (factor.hpp,
// solve.hpp).
//
// Y = U^-1 J' is made constraint by constraint, along the coordinates above its body alone (Featherstone 2008, section 6.5), by
// U's elements or, of a floating base, by what articulated bodies hand up, where U is not formed: V and J of the bodies;
// then J M^-1 J' = Y' D^-1 Y, in which two constraints meet where coordinates stand above both. Rows that say the same twice,
// or ask for what no joint can do, make it singular: it is solved by the proximal point method (Carpentier, Budhiraja and
// Mansard 2021),
//
//   (Y' D^-1 Y + R + mu N) f' = c + mu N f,   f = 0 at first,
//
// a fixed number of times. N is the mean inverse inertia along a constraint's linear rows, or its angular ones. A constraint
// that does not act has rows of zeros, a one on its diagonal and nothing on the right: its forces are zero, and nobody else's
// numbers change. A loop's Y has elements where coordinates stand above both of its bodies, though its J has none there.
//
// Their derivatives are in constraint_response.hpp, what inverse dynamics make of them in constraint_support.hpp. Nothing
// allocates; loops depend on the robot and its constraints alone.
#pragma once

#include <dalembert/constraint_blocks.hpp>
#include <dalembert/constraint_limbs.hpp>
#include <dalembert/constraint_shapes.hpp>
#include <dalembert/limbs_apart.hpp>

namespace dalembert {
namespace constraint_detail {

// What is solved in.
template <int n, class Rows, class T, int = native_lanes>
struct ConstraintBlocks {
  static constexpr int count = Rows::count, rows = Rows::block_rows(), longest = Rows::longest();
  static constexpr int padded = block_lanes(rows), block = rows * padded, w = lanes_in_block(padded), pieces = padded / w;
  T* const y;        // count x longest x padded
  T* const inertia;  // of each constraint with itself and those behind it
  T* const inverse;  // of all rows, where they are many

  explicit ConstraintBlocks(T* room)
      : y(room), inertia(y + count * longest * padded), inverse(inertia + count * (count + 1) / 2 * block) {}
  T* row(int c, int k) const { return y + (c * longest + k) * padded; }
  // b is not before a.
  T* of(int a, int b) const { return inertia + Rows::pair(a, b) * block; }

  // J's rows of a constraint, in one column of so many, times `acts`, which is zero where they are another's.
  template <int c, int coordinate, int columns>
  static DALEMBERT_INLINE void load_rows(const T* jacobian, const Lanes<T, w> (&acts)[pieces], Lanes<T, w> (&to)[pieces]) {
    constexpr int all = Rows::first(count), own = Rows::rows[c], first = coordinate * all + Rows::first(c);
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      constexpr int begin = decltype(i)::value * w, from = first + begin;
      // One more number than asked for is no harm where J goes on; two cost as much as they save.
      if constexpr (own - begin > 2 && from + w <= columns * all) to[i] = load<w>(jacobian + from);
      else
        to[i] = each_lane<w, T>(
            [&](int lane) { return begin + lane < own ? jacobian[least(from + lane, columns * all - 1)] : T(0); });
      to[i] = without_rounding<T>(to[i]) * acts[i];
    });
  }

  // One in every lane of a row that acts.
  template <int c>
  static DALEMBERT_INLINE void lanes_that_act(const T& active, Lanes<T, w> (&acts)[pieces]) {
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      constexpr int begin = decltype(i)::value * w;
      acts[i] = each_lane<w, T>([&](int lane) { return begin + lane < Rows::rows[c] ? active : T(0); });
    });
  }

  // Y of some constraints, whose wrenches on the base are handed up their limbs from body to body: what each coordinate takes
  // of one is its row of Y. wrenches: J's columns of the base; limbs: where V and J of articulated bodies are. Limbs side by
  // side, for each waits for itself alone.
  template <int begin, int behind, class Limbs>
  DALEMBERT_INLINE void fill_along_limbs(const T* wrenches, const Limbs& limbs, const T* active) const {
    using V = Lanes<T, w>;
    constexpr int base = 6, own = behind - begin;
    constexpr int most = Rows::longest(begin, behind);
    V rest[own][base][pieces];
    for_constants<own>([&](auto at) DALEMBERT_IN_BLOCK {
      constexpr int c = begin + decltype(at)::value;
      V acts[pieces];
      lanes_that_act<c>(active ? active[c] : T(1), acts);
      for_constants<base>([&](auto j)
                              DALEMBERT_IN_BLOCK { load_rows<c, decltype(j)::value, base>(wrenches, acts, rest[at][j]); });
    });
    const auto go_up = [&](int step) DALEMBERT_IN_BLOCK {
      for_constants<own>([&](auto at) DALEMBERT_IN_BLOCK {
        constexpr int c = begin + decltype(at)::value;
        const int k = Rows::lengths[c] - step;
        if (k < base) return;
        const auto at_joint = limbs.at(Rows::paths[c][k]);
        for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
          const auto along = [&](int j) DALEMBERT_IN_BLOCK { return broadcast<w, T>(at_joint.axis(j)) * rest[at][j][i]; };
          const V first = along(0) + along(1), second = along(2) + along(3), third = along(4) + along(5),
                  taken = first + second + third;
          store<w, T>(row(c, k) + i * w, taken);
          for_constants<base>([&](auto j) DALEMBERT_IN_BLOCK { rest[at][j][i] -= broadcast<w, T>(at_joint.gain(j)) * taken; });
        });
      });
    };
    if constexpr (most > base) {
      DALEMBERT_KEEP_LOOP
      for (int step = 1; step <= most - base; ++step) go_up(step);
    }
    for_constants<base>([&](auto step) DALEMBERT_IN_BLOCK {
      constexpr int k = base - 1 - decltype(step)::value;
      for_constants<own>([&](auto at) DALEMBERT_IN_BLOCK {
        for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
          store<w, T>(row(begin + at, k) + i * w, rest[at][k][i]);
          for_constants<k>(
              [&](auto j) DALEMBERT_IN_BLOCK { rest[at][j][i] -= broadcast<w, T>(limbs.base_gain(k, j)) * rest[at][k][i]; });
        });
      });
    });
  }

  // Y = U^-1 J' of one constraint, zero where it does not act.
  template <int c>
  DALEMBERT_INLINE void fill_rows(const T* jacobian, const T* factor, const T& active) const {
    using Path = typename Rows::template path<c>;
    constexpr int length = Path::length;
    Lanes<T, w> acts[pieces];
    lanes_that_act<c>(active, acts);
    if constexpr (length <= 16) {
      Lanes<T, w> own[length][pieces];
      for_constants<length>([&](auto k)
                                DALEMBERT_IN_BLOCK { load_rows<c, Path::at[decltype(k)::value], n>(jacobian, acts, own[k]); });
      for_constants<length>([&](auto step) DALEMBERT_IN_BLOCK {
        constexpr int k = length - 1 - decltype(step)::value;
        for_constants<k>([&](auto above) DALEMBERT_IN_BLOCK {
          if constexpr (Path::is_above(decltype(above)::value, k)) {
            const Lanes<T, w> times = broadcast<w, T>(factor[Path::at[k] * n + Path::at[above]]);
            for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { own[above][i] -= times * own[k][i]; });
          }
        });
        for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { store<w, T>(row(c, k) + i * w, own[k][i]); });
      });
    } else {
      for_constants<length>([&](auto k) DALEMBERT_IN_BLOCK {
        Lanes<T, w> own[pieces];
        load_rows<c, Path::at[decltype(k)::value], n>(jacobian, acts, own);
        for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { store<w, T>(row(c, k) + i * w, own[i]); });
      });
      for (int k = length - 1; k > 0; --k) {
        Lanes<T, w> below[pieces];
        for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { below[i] = load<w>(row(c, k) + i * w); });
        for (int above = 0; above < k; ++above) {
          if (!Path::is_above(above, k)) continue;
          const Lanes<T, w> times = broadcast<w, T>(factor[Path::at[k] * n + Path::at[above]]);
          T* const to = row(c, above);
          for_constants<pieces>([&](auto i)
                                    DALEMBERT_IN_BLOCK { store<w, T>(to + i * w, load<w>(to + i * w) - times * below[i]); });
        }
      }
    }
  }

  // Y, and Y' D^-1 Y. active: null, all act.
  template <class Way>
  DALEMBERT_INLINE void fill(const Way& way, const T* reciprocals, const T* active) const {
    way.fill_rows(*this, active);
    constexpr bool small = rows <= 3 && count <= 4;  // larger blocks fill the registers by themselves
    each_index<count, small>([&](auto a) DALEMBERT_IN_BLOCK {
      alignas(64) T weighted[longest * padded];
      for (int k = 0; k < Rows::lengths[a]; ++k) {
        const Lanes<T, w> reciprocal = broadcast<w, T>(reciprocals[Rows::paths[a][k]]);
        for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
          store<w, T>(weighted + k * padded + i * w, reciprocal * load<w>(row(a, k) + i * w));
        });
      }
      each_index<count, small>([&](auto b) DALEMBERT_IN_BLOCK {
        if (b < a) return;
        const auto& both = Rows::shared.pieces[Rows::pair(a, b)];
        products<rows, padded, Into::set, T>(weighted + both.a[0] * padded, row(b, both.b[0]), both.size[0], of(a, b));
        for (int i = 1; i < both.count; ++i)
          products<rows, padded, Into::add, T>(weighted + both.a[i] * padded, row(b, both.b[i]), both.size[i], of(a, b));
      });
    });
  }

  // What constraint c's own block has on its diagonal, zero where there is no row.
  using Row = BlockRow<T, w, pieces>;
  template <class C>
  DALEMBERT_INLINE Row diagonal(C c) const {
    const T* const from = of(c, c);
    Row along = {};
    for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
      constexpr int piece = decltype(r)::value / w;
      if (r < Rows::rows[c])
        along.piece[piece] =
            with_lane_of<w, T, decltype(r)::value % w>(along.piece[piece], load<w>(from + r * padded + piece * w));
    });
    return along;
  }

  // rest = rest - Y' D^-1 Y f.
  DALEMBERT_INLINE void subtract_along(const Row (&f)[count], Row (&rest)[count]) const {
    each_index<count>([&](auto a) DALEMBERT_IN_BLOCK {
      constexpr int whole = (rows + 3) / 4 * 4;
      alignas(64) T own[padded], lower[whole > padded ? whole : padded] = {};
      Row across[whole] = {};
      f[a].store(own);
      each_index<count>([&](auto b) DALEMBERT_IN_BLOCK {
        if (b < a) return;
        for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
          const T* const from = of(a, b) + r * padded;
          rest[b].template add<true>(own[r], from);
          if (b > a) across[r].add(f[b], from);
        });
      });
      if (a + 1 == count) return rest[a].subtract(Row::load(lower));
      for (int i = 0; i < whole; i += 4) totals_of_four(across + i, lower + i);
      rest[a].subtract(Row::load(lower));
    });
  }
};

// The numbers of constraint c's rows, of all rows', zero behind them.
template <class T, int own, int shift, class V, int... lane>
static DALEMBERT_INLINE V first_lanes(const V& x, std::integer_sequence<int, lane...>) {
  constexpr int n = static_cast<int>(sizeof...(lane));
  return shuffled<T, (lane < own ? lane + shift : n)...>(x, V{});
}
template <class Rows, class Row, class C, class T>
static DALEMBERT_INLINE Row own_rows(C c, const T* all) {
  constexpr int w = Row::width;
  if constexpr (std::is_same_v<C, int> || w < 2) {
    return Row::of([&](int r) { return r < Rows::rows[c] ? all[Rows::first(c) + least(r, Rows::rows[c] - 1)] : T(0); });
  } else {
    constexpr int first = Rows::first(C::value), own = Rows::rows[C::value], last = Rows::first(Rows::count) - w;
    Row row;
    for_constants<Row::size>([&](auto i) DALEMBERT_IN_BLOCK {
      constexpr int begin = decltype(i)::value * w, left = own - begin, from = first + begin;
      constexpr auto lanes = std::make_integer_sequence<int, w>{};
      if constexpr (left <= 0) row.piece[i] = Lanes<T, w>{};
      else if constexpr (left >= w) row.piece[i] = load<w>(all + from);
      else if constexpr (from <= last) row.piece[i] = first_lanes<T, left, 0>(load<w>(all + from), lanes);
      else if constexpr (last >= 0) row.piece[i] = first_lanes<T, left, from - last>(load<w>(all + last), lanes);
      else row.piece[i] = each_lane<w, T>([&](int lane) { return lane < left ? all[from + least(lane, left - 1)] : T(0); });
    });
    return row;
  }
}
template <class Rows, class C, class T, int w, int pieces>
static DALEMBERT_INLINE void store_rows(C c, const BlockRow<T, w, pieces>& row, T* all) {
  if constexpr (std::is_same_v<C, int>) {
    alignas(64) T numbers[w * pieces];
    row.store(numbers);
    for (int r = 0; r < Rows::rows[c]; ++r) all[Rows::first(c) + r] = numbers[r];
  } else {
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      constexpr int begin = decltype(i)::value * w, left = least(Rows::rows[C::value] - begin, w);
      if constexpr (left > 0) store_first<left, w, T>(all + Rows::first(C::value) + begin, row.piece[i]);
    });
  }
}

// Columns padded as blocks are, constraint by constraint.
template <class Rows, int padded, int = native_lanes>
struct BlockColumns {
  static constexpr int of(int r) {
    int c = 0;
    while (r >= Rows::first(c + 1)) ++c;
    return c * padded + r - Rows::first(c);
  }
};
// Registers of four are too few for it. clang 14 keeps the rows in memory all the same, and takes twice as long.
#if defined(__clang__)
inline constexpr bool few_rows_stay_in_registers = false;
#else
inline constexpr bool few_rows_stay_in_registers = native_lanes >= 8;
#endif

// The inverse of all rows together: of few, in registers.
template <class Blocks, class Rows, class T>
struct InverseOfFewRows {
  static constexpr int count = Rows::count, m = Rows::first(count), padded = Blocks::padded;
  static constexpr int w = native_lanes, pieces = (count * padded + w - 1) / w, joined = w / Blocks::w;
  using Row = BlockRow<T, Blocks::w, Blocks::pieces>;
  using All = BlockRow<T, w, pieces>;
  RowsInRegisters<m, pieces, BlockColumns<Rows, padded>, T> inverse;

  static DALEMBERT_INLINE All together(const Row (&each)[count]) {
    All all;
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      if constexpr (joined == 1) {
        all.piece[i] = each[i / Blocks::pieces].piece[i % Blocks::pieces];
      } else {
        const Lanes<T, Blocks::w> none{};
        constexpr bool both = 2 * decltype(i)::value + 1 < count;
        all.piece[i] = detail::joined<T>(each[2 * i].piece[0], both ? each[both ? 2 * i + 1 : 0].piece[0] : none);
      }
    });
    return all;
  }
  static DALEMBERT_INLINE void apart(const All& all, Row (&each)[count]) {
    for_constants<count>([&](auto c) DALEMBERT_IN_BLOCK {
      for_constants<Blocks::pieces>([&](auto i) DALEMBERT_IN_BLOCK {
        constexpr int at = decltype(c)::value * Blocks::pieces + decltype(i)::value;
        if constexpr (joined == 1) each[c].piece[i] = all.piece[at];
        else each[c].piece[i] = detail::half<T, at % 2>(all.piece[at / 2]);
      });
    });
  }

  // more: what the diagonal has more.
  DALEMBERT_INLINE InverseOfFewRows(const Blocks& blocks, const Row (&more)[count]) {
    for_constants<count>([&](auto a) DALEMBERT_IN_BLOCK {
      for_constants<Rows::rows[a]>([&](auto r) DALEMBERT_IN_BLOCK {
        Row each[count] = {};
        for_constants<count - a>(
            [&](auto behind) DALEMBERT_IN_BLOCK { each[a + behind] = Row::load(blocks.of(a, a + behind) + r * padded); });
        each[a] = each[a].with_only(more[a], r);
        inverse.rows[Rows::first(a) + r] = together(each);
      });
    });
    inverse.invert();
  }

  DALEMBERT_INLINE void diagonal(Row (&to)[count]) const { apart(inverse.diagonal(), to); }

  DALEMBERT_INLINE void solve(Row (&rest)[count], Row (&to)[count]) const { apart(inverse.times(together(rest)), to); }

  // A row behind the other, `stride` numbers each, of which the last are zero.
  template <int stride>
  DALEMBERT_INLINE void keep(T* to) const {
    for_constants<m>([&](auto r) DALEMBERT_IN_BLOCK {
      Row each[count];
      apart(inverse.rows[r], each);
      if constexpr (m < stride)
        for (int i = m; i < stride; ++i) to[r * stride + i] = T(0);
      for_constants<count>([&](auto c) DALEMBERT_IN_BLOCK { store_rows<Rows>(c, each[c], to + r * stride); });
    });
  }

  // All steps but the last.
  DALEMBERT_INLINE void solve(const Row (&known)[count], const Row (&held)[count], Row (&solved)[count]) const {
    const All all_known = together(known), all_held = together(held);
    All now = inverse.times(all_known);
    for_constants<Proximal<T>::steps - 2>([&](auto) DALEMBERT_IN_BLOCK { now = inverse.times(all_known.plus(all_held, now)); });
    apart(now, solved);
  }
};

// Of more, where there is room: one constraint's rows behind the other's.
template <class Blocks, class Rows, class T>
struct InverseOfManyRows {
  static constexpr int count = Rows::count, m = Rows::first(count), padded = rows_in_lanes(m);
  static constexpr int behind = 8;  // of what is written a block at a time
  using Row = BlockRow<T, Blocks::w, Blocks::pieces>;
  alignas(64) T own[in_registers(m) ? m * padded + behind : 1];  // which have no room
  T* const inverse;

  // more: what the diagonal has more.
  DALEMBERT_INLINE InverseOfManyRows(const Blocks& blocks, const Row (&more)[count])
      : inverse(in_registers(m) ? own : blocks.inverse) {
    // What a block has behind its own is written over by what follows it, if not by the next row.
    for (int a = 0; a < count; ++a)
      for_constants<Blocks::rows>([&](auto r) DALEMBERT_IN_BLOCK {
        if (r >= Rows::rows[a]) return;
        T* const to = inverse + (Rows::first(a) + r) * padded;
        const auto block = [&](int b) DALEMBERT_IN_BLOCK { return Row::load(blocks.of(a, b) + r * Blocks::padded); };
        block(a).with_only(more[a], r).store(to + Rows::first(a));
        for (int b = a + 1; b < count; ++b) block(b).store(to + Rows::first(b));
      });
    invert_rows<m, padded>(inverse);
  }

  DALEMBERT_INLINE void diagonal(Row (&to)[count]) const {
    T of_rows[m];
    for (int r = 0; r < m; ++r) of_rows[r] = inverse[r * (padded + 1)];
    each_index<count>([&](auto c) DALEMBERT_IN_BLOCK { to[c] = own_rows<Rows, Row>(c, of_rows); });
  }

  DALEMBERT_INLINE void solve(Row (&rest)[count], Row (&to)[count]) const {
    alignas(64) T x[padded + behind], result[padded + behind] = {};
    for (int c = 0; c < count; ++c) rest[c].store(x + Rows::first(c));
    constexpr int w = native_lanes, pieces = padded / w;
    if constexpr (pieces <= 6) {  // two sums each, so that one need not wait for the other
      Lanes<T, w> even[pieces] = {}, odd[pieces] = {};
      const auto add = [&](Lanes<T, w>(&sum)[pieces], int r) DALEMBERT_IN_BLOCK {
        for_constants<pieces>(
            [&](auto i) DALEMBERT_IN_BLOCK { sum[i] += broadcast<w, T>(x[r]) * load<w>(inverse + r * padded + i * w); });
      };
      DALEMBERT_KEEP_LOOP
      for (int r = 0; r + 1 < m; r += 2) add(even, r), add(odd, r + 1);
      if constexpr (m % 2 == 1) add(even, m - 1);
      for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { store<w, T>(result + i * w, even[i] + odd[i]); });
    } else {
      sum_columns<1, m, false, T>(
          m, [&](int, int r) { return x[r]; }, [&](int r) { return inverse + r * padded; },
          [](int) -> const T* { return nullptr; }, [&](int) { return result; });
    }
    for (int i = m; i < padded; ++i) result[i] = T(0);  // sums of what the room had there
    for (int c = 0; c < count; ++c) to[c] = Row::load(result + Rows::first(c));
  }

  template <int stride>
  DALEMBERT_INLINE void keep(T* to) const {
    static_assert(stride == padded, "both in the lanes of the target");
    for (int i = 0; i < m * padded; ++i) to[i] = i % padded < m ? inverse[i] : T(0);
  }

  // All steps but the last.
  DALEMBERT_INLINE void solve(const Row (&known)[count], const Row (&held)[count], Row (&solved)[count]) const {
    for (int step = 0; step < Proximal<T>::steps - 1; ++step) {
      Row rest[count];
      for (int c = 0; c < count; ++c) rest[c] = step > 0 ? known[c].plus(held[c], solved[c]) : known[c];
      solve(rest, solved);
    }
  }
};

// x = U^-1 x.
template <int n, class Tree, class T>
static DALEMBERT_INLINE void eliminate_upwards(const T* factor, T* x) {
  for_constants<Tree::count>([&](auto step) DALEMBERT_IN_BLOCK {
    using Chain = typename Tree::template chain<Tree::count - 1 - decltype(step)::value>;
    constexpr int first = Chain::first, count = Chain::count;
    for_constants<count>([&](auto back) DALEMBERT_IN_BLOCK {
      constexpr int k = count - 1 - decltype(back)::value;
      for_constants<k>([&](auto i) DALEMBERT_IN_BLOCK { x[first + i] -= factor[(first + k) * n + first + i] * x[first + k]; });
    });
    for_constants<Chain::run_count>([&](auto r) DALEMBERT_IN_BLOCK {
      constexpr int begin = Chain::run[2 * r], size = Chain::run[2 * r + 1] - begin;
      each_piece<size>([&](auto lanes, auto at) DALEMBERT_IN_BLOCK {
        constexpr int w = decltype(lanes)::value, from = begin + decltype(at)::value;
        Lanes<T, w> rest = load<w>(x + from);
        for_constants<count>([&](auto k) DALEMBERT_IN_BLOCK {
          rest -= broadcast<w, T>(x[first + k]) * load<w>(factor + (first + k) * n + from);
        });
        store<w, T>(x + from, rest);
      });
    });
  });
}

// x = U'^-1 D^-1 x.
template <int n, class Tree, class T>
static DALEMBERT_INLINE void substitute_downwards(const T* factor, const T* reciprocals, T* x) {
  for_constants<Tree::count>([&](auto c) DALEMBERT_IN_BLOCK {
    using Chain = typename Tree::template chain<decltype(c)::value>;
    constexpr int first = Chain::first, count = Chain::count;
    for_constants<count>([&](auto k) DALEMBERT_IN_BLOCK {
      const T* const column = factor + (first + k) * n;
      T rest = x[first + k] * reciprocals[first + k];
      for_constants<Chain::run_count>([&](auto r) DALEMBERT_IN_BLOCK {
        constexpr int begin = Chain::run[2 * r], size = Chain::run[2 * r + 1] - begin;
        each_piece<size>([&](auto lanes, auto at) DALEMBERT_IN_BLOCK {
          constexpr int w = decltype(lanes)::value, from = begin + decltype(at)::value;
          const Lanes<T, w> product = load<w>(column + from) * load<w>(x + from);
          for_constants<w>([&](auto i) DALEMBERT_IN_BLOCK { rest -= lane<w, T>(product, i); });
        });
      });
      for_constants<decltype(k)::value>([&](auto i) DALEMBERT_IN_BLOCK { rest -= column[first + i] * x[first + i]; });
      x[first + k] = rest;
    });
  });
}

// How rows and efforts go up the tree, and accelerations down: by M's factors,
template <int n, class T, int = native_lanes>
struct WayByFactor {
  const T *jacobian, *factor, *pivots;

  template <class Rows>
  DALEMBERT_INLINE void reciprocals_of_pivots(T* reciprocals) const {
    for (int k = 0; k < n; ++k) reciprocals[k] = T(1) / pivots[k];
  }

  template <class Blocks>
  DALEMBERT_INLINE void fill_rows(const Blocks& blocks, const T* active) const {
    for_constants<Blocks::count>([&](auto c) DALEMBERT_IN_BLOCK {
      blocks.template fill_rows<decltype(c)::value>(jacobian, factor, active ? active[c] : T(1));
    });
  }
  // x = U^-1 x; scaled: D^-1 of it.
  template <class Tree>
  DALEMBERT_INLINE void upwards(const T* reciprocals, T* x, T* scaled) const {
    eliminate_upwards<n, Tree>(factor, x);
    for (int k = 0; k < n; ++k) scaled[k] = x[k] * reciprocals[k];
  }
  // x = M^-1 (e + J' f), pushed being Y f of the coordinates above constraints.
  template <class Tree, class Rows>
  DALEMBERT_INLINE void downwards(const T* reciprocals, const T* pushed, T* x) const {
    for (int i = 0; i < Rows::moving.size; ++i) x[Rows::moving.at[i]] += pushed[i];
    substitute_downwards<n, Tree>(factor, reciprocals, x);
  }
};
// or by articulated bodies, where x comes as what `upwards` makes.
template <int n, class Limbs, class T, int = native_lanes>
struct WayByLimbs {
  const T* wrenches;
  const Limbs& limbs;

  // Of the coordinates above constraints: nobody asks for others'.
  template <class Rows>
  DALEMBERT_INLINE void reciprocals_of_pivots(T* reciprocals) const {
    constexpr auto& moving = Rows::moving;
    constexpr int w = native_lanes, whole = (moving.size + w - 1) / w * w;
    T own[whole > 0 ? whole : 1];
    // With constants for indices: of indices in a loop compilers make gathers and scatters, which are slow.
    constexpr bool constants = whole <= 64;
    each_index<whole / w, constants>([&](auto piece) DALEMBERT_IN_BLOCK {
      const int from = piece * w;
      const Lanes<T, w> pivots = each_lane<w, T>([&](int lane) DALEMBERT_IN_BLOCK {
        return from + lane < moving.size ? limbs.pivot(moving.at[least(from + lane, moving.size - 1)]) : T(1);
      });
      store<w, T>(own + from, T(1) / pivots);
    });
    each_index<moving.size, constants>([&](auto i) DALEMBERT_IN_BLOCK { reciprocals[moving.at[i]] = own[i]; });
  }

  template <class Blocks>
  DALEMBERT_INLINE void fill_rows(const Blocks& blocks, const T* active) const {
    constexpr int together = Blocks::w < 8 && native_lanes < 8 ? 1 : 4, count = Blocks::count;  // as many as registers hold
    for_constants<(count + together - 1) / together>([&](auto group) DALEMBERT_IN_BLOCK {
      constexpr int begin = decltype(group)::value * together;
      blocks.template fill_along_limbs<begin, least(begin + together, count)>(wrenches, limbs, active);
    });
  }
  template <class Tree>
  DALEMBERT_INLINE void upwards(const T*, const T* x, T* scaled) const {
    for (int k = 0; k < n; ++k) scaled[k] = x[k];
  }
  template <class Tree, class Rows>
  DALEMBERT_INLINE void downwards(const T* reciprocals, const T* pushed, T* x) const {
    for (int i = 0; i < Rows::moving.size; ++i) x[Rows::moving.at[i]] += reciprocals[Rows::moving.at[i]] * pushed[i];
    accelerate_outwards<Tree>(limbs, x);
  }
};

template <int n, class Rows, class Way, class T>
static DALEMBERT_INLINE void delassus(const Way& way, T* room, T* to) {
  using Blocks = ConstraintBlocks<n, Rows, T>;
  constexpr int all = Rows::first(Rows::count);
  const Blocks blocks(room);
  T reciprocals[n];
  way.template reciprocals_of_pivots<Rows>(reciprocals);
  blocks.fill(way, reciprocals, static_cast<const T*>(nullptr));
  each_index<Rows::count>([&](auto a) DALEMBERT_IN_BLOCK {
    each_index<Rows::count>([&](auto b) DALEMBERT_IN_BLOCK {
      if (b < a) return;
      const T* const block = blocks.of(a, b);
      T *const upper = to + Rows::first(b) * all + Rows::first(a), *const lower = to + Rows::first(a) * all + Rows::first(b);
      for (int r = 0; r < Rows::rows[a]; ++r)
        for (int s = 0; s < Rows::rows[b]; ++s) upper[s * all + r] = lower[r * all + s] = block[r * Blocks::padded + s];
    });
  });
}

// at_rest: whether x is zero. kept: null, or where the inverse of all rows goes, rows_in_lanes() numbers each, and behind it mu
// N.
template <int n, class Rows, class Tree, bool at_rest, class Way, class T>
static DALEMBERT_INLINE ConstraintStatus<T> solve(const Way& way, const T* right, const T* active, const T* regularization,
                                                  T* room, T* forces, T* x, T* kept = nullptr) {
  using Blocks = ConstraintBlocks<n, Rows, T>;
  constexpr int count = Rows::count, padded = Blocks::padded, w = Blocks::w;
  const Blocks blocks(room);
  T reciprocals[n], scaled[at_rest ? 1 : n];
  way.template reciprocals_of_pivots<Rows>(reciprocals);
  if constexpr (!at_rest) way.template upwards<Tree>(reciprocals, x, scaled);
  blocks.fill(way, reciprocals, active);

  // c, mu N, and what the diagonal has more. What no row stands for is a one.
  constexpr int pieces = Blocks::pieces;
  using V = Lanes<T, w>;
  using Row = BlockRow<T, w, pieces>;
  const V none{}, one = broadcast<w, T>(T(1));
  Row known[count], held[count], regular[count], more[count];
  V negative{};
  T sums[count][2], sum = T(0);
  each_index<count>([&](auto c) DALEMBERT_IN_BLOCK {
    const int own = Rows::rows[c], linear = Rows::linear[c];
    const T* const block = blocks.of(c, c);
    T of_linear = T(0), of_angular = T(0);
    for (int r = 0; r < linear; ++r) of_linear += block[r * (padded + 1)];
    for (int r = linear; r < own; ++r) of_angular += block[r * (padded + 1)];
    sums[c][0] = of_linear, sums[c][1] = of_angular;
  });
  for (int c = 0; c < count; ++c) sum += sums[c][0] + sums[c][1];
  each_index<count>([&](auto c) DALEMBERT_IN_BLOCK {
    const int own = Rows::rows[c], linear = Rows::linear[c];
    const V acting = broadcast<w, T>(active[c]);
    const auto mean = [&](int i, int rows_of_it) DALEMBERT_IN_BLOCK {
      const T all = T(least_share) * sum + sums[c][i] * (T(1) / T(rows_of_it > 0 ? rows_of_it : 1));
      return broadcast<w, T>(all > T(0) ? all : T(1));
    };
    const V of_linear = mean(0, linear), of_angular = mean(1, own - linear);
    const Row along = blocks.diagonal(c), sides[] = {own_rows<Rows, Row>(c, regularization), own_rows<Rows, Row>(c, right)};
    Row left[2] = {};
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      const V row = each_lane<w, T>([](int lane) { return T(decltype(i)::value * Row::width + lane); });
      const V means = row < broadcast<w, T>(T(linear)) ? of_linear : of_angular;
      const V hold = (along.piece[i] > none ? broadcast<w, T>(Proximal<T>::mu) : one) * means;
      const auto is_own = row < broadcast<w, T>(T(own));
      held[c].piece[i] = is_own ? acting > none ? hold : none : none;
      regular[c].piece[i] = acting > none ? sides[0].piece[i] : none;
      negative += regular[c].piece[i] < none ? one : none;
      more[c].piece[i] = is_own ? acting > none ? hold + regular[c].piece[i] : one : one;
      left[0].piece[i] = acting > none ? sides[1].piece[i] : none;
    });
    if constexpr (!at_rest) {
      each_above<Rows>(
          c, [&](auto k) DALEMBERT_IN_BLOCK { left[k % 2].template add<true>(scaled[Rows::paths[c][k]], blocks.row(c, k)); });
      left[0].add(left[1]);
    }
    known[c] = left[0];
  });

  using Solver = std::conditional_t<in_registers(Rows::first(count)) && few_rows_stay_in_registers,
                                    InverseOfFewRows<Blocks, Rows, T>, InverseOfManyRows<Blocks, Rows, T>>;
  const Solver solver(blocks, more);
  if (kept) {
    constexpr int stride = rows_in_lanes(Rows::first(count));
    solver.template keep<stride>(kept);
    each_index<count>([&](auto c) DALEMBERT_IN_BLOCK { store_rows<Rows>(c, held[c], kept + Rows::first(count) * stride); });
  }
  ConstraintStatus<T> status;
  Row left_of[count];
  solver.diagonal(left_of);
  int acting = 0;
  RedundancyInLanes<T, w> redundancy;
  each_index<count>([&](auto c) DALEMBERT_IN_BLOCK {
    acting += active[c] > T(0) ? Rows::rows[c] : 0;
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { redundancy.add(held[c].piece[i] * left_of[c].piece[i]); });
  });
  redundancy.of_all().tell(acting, status);
  if (BlockRow<T, w, 1>{{negative}}.total() > T(0)) status.least_pivot = T(-1);

  // Products with an inverse leave an error of its condition: the last step adds what is missing.
  Row before[count], rest[count], solved[count];
  solver.solve(known, held, before);
  each_index<count>([&](auto c) DALEMBERT_IN_BLOCK { rest[c] = known[c].minus(regular[c], before[c]); });
  blocks.subtract_along(before, rest);
  solver.solve(rest, solved);
  each_index<count>([&](auto c) DALEMBERT_IN_BLOCK { solved[c].add(before[c]); });
  ErrorInLanes<T, w> error;
  each_index<count>([&](auto c) DALEMBERT_IN_BLOCK {
    store_rows<Rows>(c, solved[c], forces);
    for_constants<pieces>([&](auto i)
                              DALEMBERT_IN_BLOCK { error.add(held[c].piece[i] * (solved[c].piece[i] - before[c].piece[i])); });
  });
  status.residual = error.of_all();

  constexpr auto& moving = Rows::moving;
  constexpr int whole = (moving.size + 3) / 4 * 4;
  T pushed[whole > 0 ? whole : 1];  // Y f
  if constexpr (count <= 4 && whole <= 32) {
    for_constants<whole / 4>([&](auto four) DALEMBERT_IN_BLOCK {
      Row in_lanes[4] = {};
      for_constants<4>([&](auto i) DALEMBERT_IN_BLOCK {
        for_constants<count>([&](auto c) DALEMBERT_IN_BLOCK {
          constexpr int k = Rows::along(decltype(c)::value, 4 * decltype(four)::value + decltype(i)::value);
          if constexpr (k >= 0) in_lanes[i].add(solved[c], blocks.row(c, k));
        });
      });
      totals_of_four(in_lanes, pushed + 4 * decltype(four)::value);
    });
  } else {
    Row in_lanes[whole > 0 ? whole : 1] = {};
    for (int c = 0; c < count; ++c)
      for (int k = 0; k < Rows::lengths[c]; ++k) in_lanes[moving.of[c][k]].add(solved[c], blocks.row(c, k));
    for (int i = 0; i < whole; i += 4) totals_of_four(in_lanes + i, pushed + i);
  }
  way.template downwards<Tree, Rows>(reciprocals, pushed, x);
  return status;
}

template <int n, class Rows, class Tree, bool at_rest, class Limbs, class T>
static DALEMBERT_INLINE ConstraintStatus<T> solve_by_limbs(const Limbs& limbs, const T* wrenches, const T* right,
                                                           const T* active, const T* regularization, T* room, T* forces, T* x) {
  if constexpr (are_points_of_limbs_apart<Rows, Limbs>()) {
    static_cast<void>(room);  // made for any number of lanes
    return solve_limbs_apart<n, Rows, Tree, at_rest>(limbs, wrenches, right, active, regularization, forces, x);
  } else {
    return solve<n, Rows, Tree, at_rest>(WayByLimbs<n, Limbs, T>{wrenches, limbs}, right, active, regularization, room, forces,
                                         x);
  }
}

}  // namespace constraint_detail

// to = J M^-1 J', all rows of all constraints, whether they act or not.
template <int n, class Rows, class T>
__attribute__((noinline)) static void delassus(const T* jacobian, const T* factor, const T* pivots, T* room, T* to) noexcept {
  constraint_detail::delassus<n, Rows>(constraint_detail::WayByFactor<n, T>{jacobian, factor, pivots}, room, to);
}
// The same of a floating base by articulated bodies: M is L' D L, L_ki = V_k.J_i. wrenches: J's columns of the base.
template <int n, class Rows, class Limbs, class T>
__attribute__((noinline)) static void delassus_by_limbs(const Limbs& limbs, const T* wrenches, T* room, T* to) noexcept {
  if constexpr (constraint_detail::are_points_of_limbs_apart<Rows, Limbs>()) {
    static_cast<void>(room);
    constraint_detail::LimbsApart<Rows, Limbs, T> apart(limbs);
    apart.fill(wrenches, constraint_detail::ConstraintsBeside<Rows, Limbs, T>::of_constraints([](int) { return T(1); }));
    apart.delassus(to);
  } else {
    constraint_detail::delassus<n, Rows>(constraint_detail::WayByLimbs<n, Limbs, T>{wrenches, limbs}, room, to);
  }
}

// x becomes M^-1 (x + J' f), and f what makes J x = b. factor: M's U, of which the half above the diagonal is read. right: b.
// active: 1 or 0 per constraint. regularization: R, per row.
template <int n, class Rows, class Tree, class T>
__attribute__((noinline)) static ConstraintStatus<T> solve_constrained(const T* jacobian, const T* factor, const T* pivots,
                                                                       const T* right, const T* active, const T* regularization,
                                                                       T* room, T* forces, T* x) noexcept {
  return constraint_detail::solve<n, Rows, Tree, false>(constraint_detail::WayByFactor<n, T>{jacobian, factor, pivots}, right,
                                                        active, regularization, room, forces, x);
}
// The same, which leaves in `response` what respond() goes on with.
template <int n, class Rows, class Tree, class T>
__attribute__((noinline)) static ConstraintStatus<T> solve_constrained(const T* jacobian, const T* factor, const T* pivots,
                                                                       const T* right, const T* active, const T* regularization,
                                                                       T* room, T* forces, T* x, T* response) noexcept {
  return constraint_detail::solve<n, Rows, Tree, false>(constraint_detail::WayByFactor<n, T>{jacobian, factor, pivots}, right,
                                                        active, regularization, room, forces, x, response);
}
// The same by articulated bodies; x comes as D^-1 L'^-1 of the efforts, which is L dv without constraints.
template <int n, class Rows, class Tree, class Limbs, class T>
__attribute__((noinline)) static ConstraintStatus<T> solve_constrained_by_limbs(const Limbs& limbs, const T* wrenches,
                                                                                const T* right, const T* active,
                                                                                const T* regularization, T* room, T* forces,
                                                                                T* x) noexcept {
  return constraint_detail::solve_by_limbs<n, Rows, Tree, false>(limbs, wrenches, right, active, regularization, room, forces,
                                                                 x);
}

// v becomes what it is after an impact, v + M^-1 J' f, f being the impulses that change J v by `right`.
template <int n, class Rows, class Tree, class T>
__attribute__((noinline)) static ConstraintStatus<T> solve_impact(const T* jacobian, const T* factor, const T* pivots,
                                                                  const T* right, const T* active, const T* regularization,
                                                                  T* room, T* impulses, T* v) noexcept {
  T change[n] = {};
  const ConstraintStatus<T> status = constraint_detail::solve<n, Rows, Tree, true>(
      constraint_detail::WayByFactor<n, T>{jacobian, factor, pivots}, right, active, regularization, room, impulses, change);
  for (int k = 0; k < n; ++k) v[k] += change[k];
  return status;
}
template <int n, class Rows, class Tree, class Limbs, class T>
__attribute__((noinline)) static ConstraintStatus<T> solve_impact_by_limbs(const Limbs& limbs, const T* wrenches,
                                                                           const T* right, const T* active,
                                                                           const T* regularization, T* room, T* impulses,
                                                                           T* v) noexcept {
  T change[n] = {};
  const ConstraintStatus<T> status = constraint_detail::solve_by_limbs<n, Rows, Tree, true>(
      limbs, wrenches, right, active, regularization, room, impulses, change);
  for (int k = 0; k < n; ++k) v[k] += change[k];
  return status;
}

}  // namespace dalembert
