// Accelerations that keep to constraints: M dv = e + J' f, J dv = b, with M's factors along the tree, M = U D U' (factor.hpp,
// solve.hpp).
//
// Y = U^-1 J' is made constraint by constraint, along the coordinates above its body alone (Featherstone 2008, section 6.5);
// then J M^-1 J' = Y' D^-1 Y, in which two constraints meet where coordinates stand above both. Rows that say the same twice,
// or ask for what no joint can do, make it singular: it is solved by the proximal point method (Carpentier, Budhiraja and
// Mansard 2021),
//
//   (Y' D^-1 Y + R + mu N) f' = c + mu N f,   f = 0 at first,
//
// a fixed number of times. N is the mean inverse inertia along a block's three rows. A constraint that does not act has rows of
// zeros, a one on its diagonal and nothing on the right: its forces are zero, and nobody else's numbers change.
//
// Nothing allocates; loops depend on the robot and its constraints alone.
#pragma once

#include <dalembert/constraint_shapes.hpp>
#include <dalembert/factor.hpp>
#include <tuple>

namespace dalembert {

// What solving for constraints came to.
template <class T>
struct ConstraintStatus {
  T residual = T(0);     // the largest error that is left of a row that acts, m/s^2 or rad/s^2; of an impact, m/s or rad/s
  T least_pivot = T(1);  // the least pivot, in terms of N; at most 1: near mu where rows say what others say
  int rank = 0;          // how many rows that act say something new
};

// A constraint: its rows, and the coordinates above its body, the tree's root first.
template <int own_rows, int... coordinates>
struct RowPath {
  static constexpr int rows = own_rows, length = sizeof...(coordinates);
  static constexpr int at[] = {coordinates...};
};

// All constraints, in the order of their rows.
template <class... Paths>
struct ConstraintRows {
  static constexpr int count = sizeof...(Paths);
  static constexpr int rows[] = {Paths::rows...}, lengths[] = {Paths::length...};
  static constexpr const int* paths[] = {Paths::at...};
  template <int c>
  using path = std::tuple_element_t<c, std::tuple<Paths...>>;

  // Row of a constraint; of `count`: how many there are.
  static constexpr int first(int c) {
    int row = 0;
    for (int i = 0; i < c; ++i) row += rows[i];
    return row;
  }
  static constexpr int block_rows() {
    int most = 0;
    for (const int r : rows) most = r > most ? r : most;
    return dalembert::block_rows(most);
  }
  static constexpr int longest() {
    int most = 0;
    for (const int length : lengths) most = length > most ? length : most;
    return most;
  }
  // How many coordinates stand above both.
  static constexpr int shared(int a, int b) {
    int both = 0;
    while (both < least(lengths[a], lengths[b]) && paths[a][both] == paths[b][both]) ++both;
    return both;
  }
};

// A chain of coordinates as in factor.hpp, and where those above it stand, in runs: begin, behind, begin, behind …
template <int chain_first, int chain_count, int... runs>
struct ChainBelow {
  static constexpr int first = chain_first, count = chain_count, run_count = sizeof...(runs) / 2;
  static constexpr int run[sizeof...(runs) + 1] = {runs..., 0};
};
// From the root on.
template <class... Chains>
struct ChainTree {
  static constexpr int count = sizeof...(Chains);
  template <int c>
  using chain = std::tuple_element_t<c, std::tuple<Chains...>>;
};

namespace constraint_detail {

using detail::for_constants;

constexpr int lanes_in_block(int padded) { return least(native_lanes, padded); }

// x[0] y[0] + … of a block's lanes.
template <int padded, class T>
DALEMBERT_INLINE T block_dot(const T* x, const T* y) {
  constexpr int w = lanes_in_block(padded);
  Lanes<T, w> sum = load<w>(x) * load<w>(y);
  for_constants<padded / w - 1>([&](auto i) DALEMBERT_IN_BLOCK {
    constexpr int at = (decltype(i)::value + 1) * w;
    sum += load<w>(x + at) * load<w>(y + at);
  });
  T total = lane<w, T>(sum, 0);
  for_constants<w - 1>([&](auto i) DALEMBERT_IN_BLOCK { total += lane<w, T>(sum, decltype(i)::value + 1); });
  return total;
}

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

// to[s] += the sum over r of x[r] a[r][s], or less it.
template <int rows, int padded, bool negative, class T>
DALEMBERT_INLINE void add_rows(const T* a, const T* x, T* to) {
  constexpr int w = lanes_in_block(padded), pieces = padded / w;
  Lanes<T, w> sum[pieces];
  for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { sum[i] = load<w>(to + i * w); });
  for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
    const Lanes<T, w> factor = broadcast<w, T>(x[r]);
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      if constexpr (negative) sum[i] -= factor * load<w>(a + r * padded + i * w);
      else sum[i] += factor * load<w>(a + r * padded + i * w);
    });
  });
  for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { store<w, T>(to + i * w, sum[i]); });
}

// A symmetric positive definite block becomes its inverse (Gauss and Jordan); its pivots are kept.
template <int rows, int padded, class T>
DALEMBERT_INLINE void invert_block(T* block, T* pivots) {
  constexpr int w = lanes_in_block(padded), pieces = padded / w;
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

// What is solved in.
template <int n, class Rows, class T>
struct ConstraintBlocks {
  static constexpr int count = Rows::count, rows = Rows::block_rows(), longest = Rows::longest();
  static constexpr int padded = block_lanes(rows), block = rows * padded, w = lanes_in_block(padded), pieces = padded / w;
  T* const y;        // count x longest x padded
  T* const inertia;  // of each constraint with itself and those behind it
  T* const scaled;   // of each with those behind it: eliminated

  explicit ConstraintBlocks(T* room)
      : y(room), inertia(y + count * longest * padded), scaled(inertia + count * (count + 1) / 2 * block) {}
  T* row(int c, int k) const { return y + (c * longest + k) * padded; }
  // b is not before a.
  T* of(int a, int b) const { return inertia + (a * count - a * (a - 1) / 2 + b - a) * block; }
  T* eliminated(int a, int b) const { return scaled + (a * (count - 1) - a * (a - 1) / 2 + b - a - 1) * block; }

  // J's rows of a constraint, in one column, times `acts` where they are its own.
  template <int c>
  static DALEMBERT_INLINE void load_rows(const T* jacobian, int coordinate, const Lanes<T, w> (&acts)[pieces],
                                         Lanes<T, w> (&to)[pieces]) {
    constexpr int all = Rows::first(count), first = Rows::first(c), own = Rows::rows[c];
    const T* const from = jacobian + coordinate * all + first;
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      constexpr int begin = decltype(i)::value * w;
      if constexpr (begin + w <= own) to[i] = load<w>(from + begin) * acts[i];
      else
        to[i] =
            each_lane<w, T>([&](int lane) { return begin + lane < own ? from[least(begin + lane, own - 1)] : T(0); }) * acts[i];
    });
  }

  // Y = U^-1 J' of one constraint, zero where it does not act.
  template <int c>
  DALEMBERT_INLINE void fill_rows(const T* jacobian, const T* factor, const T& active) const {
    using Path = typename Rows::template path<c>;
    constexpr int length = Path::length;
    Lanes<T, w> acts[pieces];
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { acts[i] = broadcast<w, T>(active); });
    if constexpr (length <= 16) {
      Lanes<T, w> own[length][pieces];
      for_constants<length>([&](auto k) DALEMBERT_IN_BLOCK { load_rows<c>(jacobian, Path::at[k], acts, own[k]); });
      for_constants<length>([&](auto step) DALEMBERT_IN_BLOCK {
        constexpr int k = length - 1 - decltype(step)::value;
        for_constants<k>([&](auto above) DALEMBERT_IN_BLOCK {
          const Lanes<T, w> times = broadcast<w, T>(factor[Path::at[k] * n + Path::at[above]]);
          for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { own[above][i] -= times * own[k][i]; });
        });
        for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { store<w, T>(row(c, k) + i * w, own[k][i]); });
      });
    } else {
      for (int k = 0; k < length; ++k) {
        Lanes<T, w> own[pieces];
        load_rows<c>(jacobian, Path::at[k], acts, own);
        for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { store<w, T>(row(c, k) + i * w, own[i]); });
      }
      for (int k = length - 1; k > 0; --k) {
        Lanes<T, w> below[pieces];
        for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { below[i] = load<w>(row(c, k) + i * w); });
        for (int above = 0; above < k; ++above) {
          const Lanes<T, w> times = broadcast<w, T>(factor[Path::at[k] * n + Path::at[above]]);
          T* const to = row(c, above);
          for_constants<pieces>([&](auto i)
                                    DALEMBERT_IN_BLOCK { store<w, T>(to + i * w, load<w>(to + i * w) - times * below[i]); });
        }
      }
    }
  }

  // Y, and Y' D^-1 Y. active: null, all act.
  DALEMBERT_INLINE void fill(const T* jacobian, const T* factor, const T* reciprocals, const T* active) const {
    for_constants<count>(
        [&](auto c) DALEMBERT_IN_BLOCK { fill_rows<decltype(c)::value>(jacobian, factor, active ? active[c] : T(1)); });
    for (int a = 0; a < count; ++a) {
      T weighted[longest * padded];
      for (int k = 0; k < Rows::lengths[a]; ++k) {
        const Lanes<T, w> reciprocal = broadcast<w, T>(reciprocals[Rows::paths[a][k]]);
        for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
          store<w, T>(weighted + k * padded + i * w, reciprocal * load<w>(row(a, k) + i * w));
        });
      }
      for (int b = a; b < count; ++b) products<rows, padded, Into::set, T>(weighted, row(b, 0), Rows::shared(a, b), of(a, b));
    }
  }
};

// f(how many lanes, from where on) over `count` elements, whole registers first.
template <int count, class F>
DALEMBERT_INLINE void each_piece(const F& f) {
  constexpr int w = least(native_lanes, 4), whole = count / w * w;
  for_constants<count / w>([&](auto i) DALEMBERT_IN_BLOCK {
    f(std::integral_constant<int, w>{}, std::integral_constant<int, decltype(i)::value * w>{});
  });
  if constexpr (w == 4 && (count & 2) != 0) f(std::integral_constant<int, 2>{}, std::integral_constant<int, whole>{});
  if constexpr (w > 1 && (count & 1) != 0) f(std::integral_constant<int, 1>{}, std::integral_constant<int, count - 1>{});
}

// x = U^-1 x.
template <int n, class Tree, class T>
DALEMBERT_INLINE void eliminate_upwards(const T* factor, T* x) {
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
DALEMBERT_INLINE void substitute_downwards(const T* factor, const T* reciprocals, T* x) {
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

template <int n, class T>
DALEMBERT_INLINE void reciprocals_of(const T* pivots, T* reciprocals) {
  for (int k = 0; k < n; ++k) reciprocals[k] = T(1) / pivots[k];
}

}  // namespace constraint_detail

// to = J M^-1 J', all rows of all constraints, whether they act or not.
template <int n, class Rows, class T>
__attribute__((noinline)) static void delassus(const T* jacobian, const T* factor, const T* pivots, T* room, T* to) noexcept {
  using Blocks = constraint_detail::ConstraintBlocks<n, Rows, T>;
  constexpr int all = Rows::first(Rows::count);
  const Blocks blocks(room);
  T reciprocals[n];
  constraint_detail::reciprocals_of<n>(pivots, reciprocals);
  blocks.fill(jacobian, factor, reciprocals, static_cast<const T*>(nullptr));
  for (int a = 0; a < Rows::count; ++a)
    for (int b = a; b < Rows::count; ++b)
      for (int r = 0; r < Rows::rows[a]; ++r)
        for (int s = 0; s < Rows::rows[b]; ++s) {
          const T x = blocks.of(a, b)[r * Blocks::padded + s];
          to[(Rows::first(b) + s) * all + Rows::first(a) + r] = x;
          to[(Rows::first(a) + r) * all + Rows::first(b) + s] = x;
        }
}

// x becomes M^-1 (x + J' f), and f what makes J x = b. factor: M's U, of which the half above the diagonal is read. right: b.
// active: 1 or 0 per constraint. regularization: R, per row.
template <int n, class Rows, class Tree, class T>
__attribute__((noinline)) static ConstraintStatus<T> solve_constrained(const T* jacobian, const T* factor, const T* pivots,
                                                                       const T* right, const T* active, const T* regularization,
                                                                       T* room, T* forces, T* x) noexcept {
  using Blocks = constraint_detail::ConstraintBlocks<n, Rows, T>;
  using constraint_detail::for_constants;
  using constraint_detail::Into;
  constexpr int count = Rows::count, rows = Blocks::rows, padded = Blocks::padded, all = count * padded, w = Blocks::w;
  const Blocks blocks(room);
  T reciprocals[n];
  constraint_detail::reciprocals_of<n>(pivots, reciprocals);
  constraint_detail::eliminate_upwards<n, Tree>(factor, x);
  blocks.fill(jacobian, factor, reciprocals, active);

  // c, mu N, and the diagonal. What no row stands for is a one.
  T known[all], held[all], sum = T(0);
  for (int c = 0; c < count; ++c)
    for (int r = 0; r < rows; ++r) sum += blocks.of(c, c)[r * padded + r];
  for (int c = 0; c < count; ++c) {
    const int own = Rows::rows[c];
    T* const block = blocks.of(c, c);
    T* const rest = known + c * padded;
    for (int r = rows; r < padded; ++r) rest[r] = held[c * padded + r] = T(0);
    for (int three = 0; three < rows; three += 3) {
      T mean = T(least_share) * sum;
      for (int r = three; r < three + 3; ++r) mean += block[r * padded + r] / T(3);
      mean = mean > T(0) ? mean : T(1);
      for (int r = three; r < three + 3; ++r) {
        const bool acts = r < own && active[c] > T(0);
        const T hold = acts ? Proximal<T>::mu * mean : T(0);
        held[c * padded + r] = hold;
        rest[r] = acts ? right[Rows::first(c) + r] : T(0);
        block[r * padded + r] += acts ? hold + regularization[Rows::first(c) + r] : T(1);
      }
    }
    Lanes<T, w> left[Blocks::pieces];
    for_constants<Blocks::pieces>([&](auto i) DALEMBERT_IN_BLOCK { left[i] = load<w>(rest + i * w); });
    for (int k = 0; k < Rows::lengths[c]; ++k) {
      const Lanes<T, w> rate = broadcast<w, T>(x[Rows::paths[c][k]] * reciprocals[Rows::paths[c][k]]);
      for_constants<Blocks::pieces>([&](auto i) DALEMBERT_IN_BLOCK { left[i] -= rate * load<w>(blocks.row(c, k) + i * w); });
    }
    for_constants<Blocks::pieces>([&](auto i) DALEMBERT_IN_BLOCK { store<w, T>(rest + i * w, left[i]); });
  }

  // Elimination of blocks, from the first.
  T block_pivots[all];
  for (int c = 0; c < count; ++c) {
    constraint_detail::invert_block<rows, padded, T>(blocks.of(c, c), block_pivots + c * padded);
    for (int b = c + 1; b < count; ++b)
      constraint_detail::products<rows, padded, Into::set, T>(blocks.of(c, c), blocks.of(c, b), rows, blocks.eliminated(c, b));
    for (int a = c + 1; a < count; ++a)
      for (int b = a; b < count; ++b)
        constraint_detail::products<rows, padded, Into::subtract, T>(blocks.of(c, a), blocks.eliminated(c, b), rows,
                                                                     blocks.of(a, b));
  }

  T solved[all] = {}, before[all] = {};
  for (int step = 0; step < Proximal<T>::steps; ++step) {
    T rest[all];
    for (int i = 0; i < all; ++i) {
      before[i] = solved[i];
      rest[i] = known[i] + held[i] * solved[i];
      solved[i] = T(0);
    }
    for (int c = 0; c < count; ++c) {
      for (int b = c + 1; b < count; ++b)
        constraint_detail::add_rows<rows, padded, true, T>(blocks.eliminated(c, b), rest + c * padded, rest + b * padded);
      constraint_detail::add_rows<rows, padded, false, T>(blocks.of(c, c), rest + c * padded, solved + c * padded);
    }
    for (int c = count - 2; c >= 0; --c)
      for (int b = c + 1; b < count; ++b)
        for (int r = 0; r < rows; ++r)
          solved[c * padded + r] -=
              constraint_detail::block_dot<padded, T>(blocks.eliminated(c, b) + r * padded, solved + b * padded);
  }
  ConstraintStatus<T> status;
  for (int c = 0; c < count; ++c)
    for (int r = 0; r < Rows::rows[c]; ++r) {
      const int i = c * padded + r;
      forces[Rows::first(c) + r] = solved[i];
      if (held[i] == T(0)) continue;
      const T change = solved[i] - before[i], error = held[i] * (change < T(0) ? -change : change);
      const T pivot = block_pivots[i] * Proximal<T>::mu / held[i];
      status.residual = error > status.residual ? error : status.residual;
      status.least_pivot = pivot < status.least_pivot ? pivot : status.least_pivot;
      status.rank += pivot > T(64) * Proximal<T>::mu ? 1 : 0;
    }

  for (int c = 0; c < count; ++c)
    for (int k = 0; k < Rows::lengths[c]; ++k)
      x[Rows::paths[c][k]] += constraint_detail::block_dot<padded, T>(blocks.row(c, k), solved + c * padded);
  constraint_detail::substitute_downwards<n, Tree>(factor, reciprocals, x);
  return status;
}

// v becomes what it is after an impact, v + M^-1 J' f, f being the impulses that change J v by `right`.
template <int n, class Rows, class Tree, class T>
static inline ConstraintStatus<T> solve_impact(const T* jacobian, const T* factor, const T* pivots, const T* right,
                                               const T* active, const T* regularization, T* room, T* impulses, T* v) noexcept {
  T change[n] = {};
  const ConstraintStatus<T> status =
      solve_constrained<n, Rows, Tree>(jacobian, factor, pivots, right, active, regularization, room, impulses, change);
  for (int k = 0; k < n; ++k) v[k] += change[k];
  return status;
}

}  // namespace dalembert
