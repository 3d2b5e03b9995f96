// Matrices of pairs: the elements between the joints of limbs, in blocks of fixed size (Shin, Park and Park 2016, eq. 31-39).
//
// An element between joint k and a joint i above it, or k itself, is a sum of products of a factor of k and one of i. For M and
// C:
//
//   M_ik = F_k·J_i    C_ik = G_k·J_i    C_ki = F_k·J̇_i + H_k·J_i     (H has an angular part alone)
//
// A limb is a run of bodies without branches: its rows and columns are consecutive in the matrices. Limbs of equal length stand
// side by side in lanes, slot = first + step·width + lane, and tiles of four steps by four are turned into columns when stored,
// as many limbs at a time as a register holds. A limb on its own (width 1) has its steps in consecutive slots, and lanes run
// along them. Nothing is allocated, every loop has a length known when the code was generated.
#pragma once

#include "dalembert/tiles.hpp"

namespace dalembert {

// Where the limbs of a segment stand. Rows are rows of M and C.
struct BranchTable {
  const int* first_row;  // per lane
  const int* length;     // per lane: real steps, 0 for an empty lane
  int first_slot;

  DALEMBERT_INLINE BranchTable from(int lane) const { return {first_row + lane, length + lane, first_slot + lane}; }
};

namespace detail {

// The joints of a limb that stands among the factors, from slot `first` on.
template <class T, int n>
DALEMBERT_BLOCK Joints<T, n> joints_of(const Factors<T, n>& p, int first, int step) {
  Joints<T, n> limb{{}, p.stride, step};
  for (int f = 0; f < n; ++f) limb.at[f] = p.at[f] + first;
  return limb;
}

// f(how many, first lane) for the limbs that are computed together, then for the next; both are constants. Of limbs taken part
// by part no two steps share a register: the steps of a part do not follow one another in their slots.
template <class T, int limbs, int lane = 0, class F>
DALEMBERT_BLOCK void each_tile_part(const F& f) {
  constexpr int most = lanes_together<T, limbs>, some = most < 2 ? 2 : most;
  static_assert(some == lanes_for(limbs) || together<T>(some, 4) == 1, "steps of a part are not neighbours");
  f(std::integral_constant<int, some>{}, std::integral_constant<int, lane>{});
  if constexpr (lane + some < limbs) each_tile_part<T, limbs, lane + some>(f);
}

// The tiles between limbs side by side and the joints above them; columns [begin, end).
template <class Kinds, class Standing, int width, int steps, int above_steps, class T, int nl, int nu, class To>
DALEMBERT_BLOCK void cross_tiles(const Joints<T, nl>& lower, const BranchTable& limbs, const Joints<T, nu>& up,
                                 const BranchTable& above, const To* matrices, int leading, int begin, int end) {
  constexpr bool out = block_written_out(steps, above_steps, nl);
  each_tile<out, steps>(begin, end, [&](int c0, auto below) DALEMBERT_IN_BLOCK {
    const Joints<T, nl> p = lower.from(c0);
    each_tile<out, above_steps>(0, above_steps, [&](int r0, auto rows) DALEMBERT_IN_BLOCK {
      Place<width> at;
      lanes<width>([&](int l) DALEMBERT_IN_BLOCK {
        at.row_above[l] = above.first_row[l] + r0, at.left_above[l] = above.length[l] - r0;
        at.row_below[l] = limbs.first_row[l] + c0, at.left_below[l] = above.length[l] > 0 ? limbs.length[l] - c0 : 0;
      });
      tiles_of<out, Standing, width, decltype(rows)::value, decltype(below)::value, together<T>(width, steps), false, T>(
          Kinds{}, p, up.from(r0), at, matrices, leading);
    });
  });
}

// The tiles between limbs side by side and themselves.
template <class Kinds, int width, int steps, class T, int nl, int nu, class To>
DALEMBERT_BLOCK void limb_tiles(const Joints<T, nl>& lower, const Joints<T, nu>& upper, const BranchTable& limbs,
                                const To* matrices, int leading, int begin, int end) {
  constexpr bool out = block_written_out(steps);
  each_tile<out, steps>(begin, end, [&](int c0, auto below) DALEMBERT_IN_BLOCK {
    const Joints<T, nl> p = lower.from(c0);
    const auto tile = [&](int r0, auto rows, auto diagonal) DALEMBERT_IN_BLOCK {
      Place<width> at;
      lanes<width>([&](int l) DALEMBERT_IN_BLOCK {
        at.row_above[l] = limbs.first_row[l] + r0, at.left_above[l] = limbs.length[l] - r0;
        at.row_below[l] = limbs.first_row[l] + c0, at.left_below[l] = limbs.length[l] - c0;
      });
      constexpr int pack = together<T>(width, steps);
      tiles_of<out, EachAbove, width, decltype(rows)::value, decltype(below)::value, pack, decltype(diagonal)::value, T>(
          Kinds{}, p, upper.from(r0), at, matrices, leading);
    };
    repeat<out, (steps - 1) / 4>(
        c0 / 4, [&](int row) DALEMBERT_IN_BLOCK { tile(4 * row, std::integral_constant<int, 4>{}, std::false_type{}); });
    tile(c0, below, std::true_type{});
  });
}

}  // namespace detail

// The block of every limb of a segment with itself, `count` limbs side by side.
// matrices: column by column, `leading` apart; the columns of steps [begin, end), begin a multiple of four.
template <class Kinds, int count, int steps, class T, int nl, int nu, class To>
DALEMBERT_BLOCK void branch_blocks(const Factors<T, nl>& lower, const Factors<T, nu>& upper, const BranchTable& limbs,
                                   const To* matrices, int leading, int begin, int end) {
  detail::each_tile_part<T, count>([&](auto some, auto lane) DALEMBERT_IN_BLOCK {
    const BranchTable these = limbs.from(lane);
    detail::limb_tiles<Kinds, decltype(some)::value, steps, T>(detail::joints_of(lower, these.first_slot, lanes_for(count)),
                                                               detail::joints_of(upper, these.first_slot, lanes_for(count)),
                                                               these, matrices, leading, begin, end);
  });
}

// The blocks between the limbs of a segment and a limb above each of them, which may be another one for every lane.
// above_slot: [step][lane], the slots of the limbs above (any slot where a lane has none); above: their rows and lengths.
template <class Kinds, int count, int steps, int above_steps, class T, int nl, int nu, class To>
DALEMBERT_BLOCK void cross_blocks(const Factors<T, nl>& lower, const Factors<T, nu>& upper, const BranchTable& limbs,
                                  const int* above_slot, const BranchTable& above, const To* matrices, int leading, int begin,
                                  int end) {
  constexpr int width = lanes_for(count), stride = above_steps * width;
  T gathered[3 * nu * stride];
  detail::Joints<T, nu> up{{}, stride, width};
  for (int f = 0; f < nu; ++f) {
    up.at[f] = gathered + 3 * f * stride;
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < above_steps; ++i)
        store<width, T>(gathered + (3 * f + j) * stride + i * width,
                        gather<width, T>(upper.at[f] + j * upper.stride, above_slot + i * width));
  }
  detail::each_tile_part<T, count>([&](auto some, auto lane) DALEMBERT_IN_BLOCK {
    const BranchTable these = limbs.from(lane);
    detail::Joints<T, nu> above_these = up;
    for (int f = 0; f < nu; ++f) above_these.at[f] += lane;
    detail::cross_tiles<Kinds, detail::EachAbove, decltype(some)::value, steps, above_steps, T>(
        detail::joints_of(lower, these.first_slot, lanes_for(count)), these, above_these, above.from(lane), matrices, leading,
        begin, end);
  });
}

namespace detail {

// The same where limbs above are read where they stand: as Standing says, in slots first, first + step, ….
template <class Kinds, class Standing, int count, int steps, int above_steps, class T, int nl, int nu, class To>
DALEMBERT_BLOCK void cross_blocks_in_place(const Factors<T, nl>& lower, const Factors<T, nu>& upper, const BranchTable& limbs,
                                           int first, int step, const BranchTable& above, const To* matrices, int leading,
                                           int begin, int end) {
  each_tile_part<T, count>([&](auto some, auto lane) DALEMBERT_IN_BLOCK {
    using These = typename Standing::template Some<decltype(lane)::value, decltype(some)::value>;
    const BranchTable these = limbs.from(lane);
    cross_tiles<Kinds, These, decltype(some)::value, steps, above_steps, T>(
        joints_of(lower, these.first_slot, lanes_for(count)), these, joints_of(upper, first, step), above.from(lane), matrices,
        leading, begin, end);
  });
}

}  // namespace detail

// The same where one limb is above all lanes that have one: its joints stand in slots first, first + step, ….
template <class Kinds, int count, int steps, int above_steps, class T, int nl, int nu, class To>
DALEMBERT_BLOCK void shared_cross_blocks(const Factors<T, nl>& lower, const Factors<T, nu>& upper, const BranchTable& limbs,
                                         int first, int step, const BranchTable& above, const To* matrices, int leading,
                                         int begin, int end) {
  detail::cross_blocks_in_place<Kinds, detail::OneAbove, count, steps, above_steps, T>(lower, upper, limbs, first, step, above,
                                                                                       matrices, leading, begin, end);
}

// The same where the limbs above stand side by side themselves, from slot `first` on; Standing: LanesAbove, which of them is
// above which lane.
template <class Kinds, int count, int steps, int above_steps, class T, class Standing, int nl, int nu, class To>
DALEMBERT_BLOCK void lane_cross_blocks(const Factors<T, nl>& lower, const Factors<T, nu>& upper, const BranchTable& limbs,
                                       int first, const BranchTable& above, const To* matrices, int leading, int begin,
                                       int end) {
  detail::cross_blocks_in_place<Kinds, Standing, count, steps, above_steps, T>(
      lower, upper, limbs, first, Standing::side_by_side, above, matrices, leading, begin, end);
}

namespace detail {

// `count` steps of a floating base's columns, from step c on.
template <int width, int count, class T, class To>
DALEMBERT_BLOCK void base_columns_from(int c, int step, const T* force, int stride, const BranchTable& limbs, const To& matrix,
                                       int leading) {
  Lanes<T, width * count> f[6];
  load_all<width * count, T>(f, force + limbs.first_slot + c * step, 6, stride);
  if constexpr (count == 1) {
    Line<width> four, two;
    lanes<width>([&](int l) DALEMBERT_IN_BLOCK {
      four.column[l] = two.column[l] = limbs.first_row[l] + c;
      four.row[l] = 0, two.row[l] = 4;
      four.count[l] = c < limbs.length[l] ? 4 : 0, two.count[l] = four.count[l] / 2;
    });
    put_line<width, T>(matrix, leading, four, f, 4);
    put_line<width, T>(matrix, leading, two, f + 4, 2);
  } else {
    Lanes<T, 4> four[width * count];
    Lanes<T, 2> two[width * count];
    turn_columns<T>(f[0], f[1], f[2], f[3], four);
    turn_columns<T>(f[4], f[5], two);
    lanes<width * count>([&](int i) DALEMBERT_IN_BLOCK {
      const int joint = c + i / width, limb = i % width;
      if (joint >= limbs.length[limb]) return;
      T* const to = matrix + (limbs.first_row[limb] + joint) * leading;
      store<4, T>(to, four[i]);
      store<2, T>(to + 4, two[i]);
    });
  }
}

// Up to four steps of its rows, from step r0 on; so many of them in a register.
template <int width, int rows, int pack, class T, class To>
DALEMBERT_BLOCK void base_rows_from(int r0, int step, const T* force, int stride, const BranchTable& limbs, const To& matrix,
                                    int leading) {
  DALEMBERT_KEEP_LOOP
  for (int j = 0; j < 6; ++j) {
    Lanes<T, width * pack> f[4] = {};
    lanes<(rows + pack - 1) / pack>([&](int i) DALEMBERT_IN_BLOCK {
      f[i] = load<width * pack, T>(force + j * stride + limbs.first_slot + (r0 + pack * i) * step);
    });
    Line<width> where;
    lanes<width>([&](int l) DALEMBERT_IN_BLOCK {
      where.column[l] = j, where.row[l] = limbs.first_row[l] + r0;
      where.count[l] = least(rows, limbs.length[l] - r0);
    });
    if constexpr (pack == 1) {
      put_line<width, T>(matrix, leading, where, f, rows);
    } else {
      Lanes<T, 4> turned[width];
      turn_row<T>(f, turned);
      put_turned<width, T>(matrix, leading, where, turned);
    }
  }
}

}  // namespace detail

// Rows and columns of a floating base for the limbs of a segment. force: the six elements per slot. The base's six rows come
// first.
template <int count, int steps, class T, class To>
DALEMBERT_BLOCK void base_columns(const T* force, int stride, const BranchTable& limbs, To matrix, int leading) {
  detail::each_tile_part<T, count>([&](auto some, auto lane) DALEMBERT_IN_BLOCK {
    constexpr int n = decltype(some)::value;
    constexpr int pack = std::is_same_v<To, T*> ? detail::together<T>(n, steps) : 1, packs = steps / pack;
    const BranchTable these = limbs.from(lane);
    detail::repeat<block_written_out(steps), packs>(packs, [&](int i) DALEMBERT_IN_BLOCK {
      detail::base_columns_from<n, pack, T>(pack * i, lanes_for(count), force, stride, these, matrix, leading);
    });
    if constexpr (pack * packs < steps)
      detail::base_columns_from<n, 1, T>(steps - 1, lanes_for(count), force, stride, these, matrix, leading);
  });
}
template <int count, int steps, class T, class To>
DALEMBERT_BLOCK void base_rows(const T* force, int stride, const BranchTable& limbs, To matrix, int leading) {
  detail::each_tile_part<T, count>([&](auto some, auto lane) DALEMBERT_IN_BLOCK {
    constexpr int n = decltype(some)::value;
    const BranchTable these = limbs.from(lane);
    detail::each_tile<block_written_out(steps), steps>(0, steps, [&](int r0, auto size) DALEMBERT_IN_BLOCK {
      constexpr int rows = decltype(size)::value;
      constexpr int pack = std::is_same_v<To, T*> && rows > 2 ? detail::together<T>(n, steps) : 1;
      detail::base_rows_from<n, rows, pack, T>(r0, lanes_for(count), force, stride, these, matrix, leading);
    });
  });
}

}  // namespace dalembert
