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
// a fixed number of times. N is the mean inverse inertia along a constraint's linear rows, or its angular ones. A constraint
// that does not act has rows of zeros, a one on its diagonal and nothing on the right: its forces are zero, and nobody else's
// numbers change. A loop's Y has elements where coordinates stand above both of its bodies, though its J has none there.
//
// Derivatives: what solves both equations changes with what they ask for by
//
//   N = M^-1 - B J M^-1     B = M^-1 J' L     L = (J M^-1 J' + R)^-1:
//
// d(dv) = -N de' - B da and df = B' de' - L da, de' being what M dv + C v + g - J' f changes by at dv and f held, da the same
// of J dv + dJ v - b (Carpentier, Budhiraja and Mansard 2021). L is what proximal steps make of the identity.
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

// A constraint between two bodies: its rows, linear ones first, and the coordinates above one of them or both, in order. The
// first `own_common` are above both, those up to `own_split` and those behind above one each.
template <int own_rows, int own_linear, int own_common, int own_split, int... coordinates>
struct LoopPath {
  static constexpr int rows = own_rows, linear = own_linear, length = sizeof...(coordinates);
  static constexpr int at[] = {coordinates...};
  // Whether the i-th of them stands above the k-th.
  static constexpr bool is_above(int i, int k) { return i < k && (k < own_split || i < own_common || i >= own_split); }
};
// One between a body and the world: the coordinates above it, the tree's root first.
template <int own_rows, int... coordinates>
using RowPath =
    LoopPath<own_rows, (own_rows < 3 ? own_rows : 3), sizeof...(coordinates), sizeof...(coordinates), coordinates...>;

// Where two lists of coordinates have the same, in pieces: from which place of each, and how many.
struct SharedPieces {
  static constexpr int most = 6;
  int count = 0, a[most] = {}, b[most] = {}, size[most] = {};

  constexpr void add(int at_a, int at_b) {
    if (count > 0 && a[count - 1] + size[count - 1] == at_a && b[count - 1] + size[count - 1] == at_b) {
      ++size[count - 1];
      return;
    }
    a[count] = at_a, b[count] = at_b, size[count] = 1;
    ++count;
  }
};

// All constraints, in the order of their rows.
template <class... Paths>
struct ConstraintRows {
  static constexpr int count = sizeof...(Paths);
  static constexpr int rows[count] = {Paths::rows...}, linear[count] = {Paths::linear...}, lengths[count] = {Paths::length...};
  static constexpr const int* paths[count] = {Paths::at...};
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
  static constexpr int pair(int a, int b) { return a * count - a * (a - 1) / 2 + b - a; }  // b is not before a
  // The coordinates above both, per pair.
  struct Shared {
    SharedPieces pieces[count * (count + 1) / 2] = {};
  };
  static constexpr Shared shared_pieces() {
    Shared all;
    for (int a = 0; a < count; ++a)
      for (int b = a; b < count; ++b)
        for (int i = 0, k = 0; i < lengths[a] && k < lengths[b];) {
          if (paths[a][i] == paths[b][k]) all.pieces[pair(a, b)].add(i++, k++);
          else if (paths[a][i] < paths[b][k]) ++i;
          else ++k;
        }
    return all;
  }
  static constexpr Shared shared = shared_pieces();
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

// The numbers of a block's row, in registers.
template <class T, int w, int pieces>
struct BlockRow {
  Lanes<T, w> piece[pieces];

  static DALEMBERT_INLINE BlockRow load(const T* from) {
    BlockRow row;
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { row.piece[i] = dalembert::load<w>(from + i * w); });
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

// A symmetric positive definite block of three rows becomes its inverse, (L D L')^-1; its pivots are kept. Two of the three
// divisions go side by side: of the first pivot, and of the first times the second.
template <int padded, class T>
DALEMBERT_INLINE void invert_three(T* block, T* pivots) {
  constexpr int w = lanes_in_block(padded), pieces = padded / w;
  const T a00 = block[0], a10 = block[1], a20 = block[2], a11 = block[padded + 1], a21 = block[padded + 2],
          a22 = block[2 * padded + 2];
  const T both = a00 * a11 - a10 * a10, r0 = T(1) / a00, r_both = T(1) / both, r1 = a00 * r_both;
  const T l10 = a10 * r0, l20 = a20 * r0, rest = a21 - l10 * a20, l21 = (a00 * a21 - a10 * a20) * r_both;
  const T d2 = a22 - a20 * l20 - rest * l21, r2 = T(1) / d2;
  pivots[0] = a00, pivots[1] = both * r0, pivots[2] = d2;
  // L^-1 has -l10, m20 and -l21.
  const T m20 = l10 * l21 - l20, s20 = m20 * r2, s21 = -l21 * r2, s10 = -l10 * r1;
  const T inverse[3][3] = {{r0 - l10 * s10 + m20 * s20, s10 - l21 * s20, s20}, {s10 - l21 * s20, r1 - l21 * s21, s21}, {s20, s21, r2}};
  for_constants<3>([&](auto r) DALEMBERT_IN_BLOCK {
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      store<w, T>(block + r * padded + i * w, each_lane<w, T>([&](int lane) {
                    const int column = decltype(i)::value * w + lane;
                    return column < 3 ? inverse[r][column] : T(0);
                  }));
    });
  });
}

// A symmetric positive definite block becomes its inverse (Gauss and Jordan); its pivots are kept.
template <int rows, int padded, class T>
DALEMBERT_INLINE void invert_block(T* block, T* pivots) {
  if constexpr (rows == 3) return invert_three<padded>(block, pivots);
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
  T* of(int a, int b) const { return inertia + Rows::pair(a, b) * block; }
  T* eliminated(int a, int b) const { return scaled + (a * (count - 1) - a * (a - 1) / 2 + b - a - 1) * block; }

  // What is not a number stays so.
  static DALEMBERT_INLINE Lanes<T, w> without_rounding(const Lanes<T, w>& x) {
    const Lanes<T, w> most = broadcast<w, T>(Proximal<T>::unmoved * Proximal<T>::unmoved);
    return x * x <= most ? broadcast<w, T>(T(0)) : x;
  }

  // J's rows of a constraint, in one column, times `acts`, which is zero where they are another's.
  template <int c, int coordinate>
  static DALEMBERT_INLINE void load_rows(const T* jacobian, const Lanes<T, w> (&acts)[pieces], Lanes<T, w> (&to)[pieces]) {
    constexpr int all = Rows::first(count), own = Rows::rows[c], first = coordinate * all + Rows::first(c);
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      constexpr int begin = decltype(i)::value * w, from = first + begin;
      // One more number than asked for is no harm where J goes on; two cost as much as they save.
      if constexpr (own - begin > 2 && from + w <= n * all) to[i] = load<w>(jacobian + from);
      else
        to[i] =
            each_lane<w, T>([&](int lane) { return begin + lane < own ? jacobian[least(from + lane, n * all - 1)] : T(0); });
      to[i] = without_rounding(to[i]) * acts[i];
    });
  }

  // Y = U^-1 J' of one constraint, zero where it does not act.
  template <int c>
  DALEMBERT_INLINE void fill_rows(const T* jacobian, const T* factor, const T& active) const {
    using Path = typename Rows::template path<c>;
    constexpr int length = Path::length;
    Lanes<T, w> acts[pieces];
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
      constexpr int begin = decltype(i)::value * w;
      acts[i] = each_lane<w, T>([&](int lane) { return begin + lane < Path::rows ? active : T(0); });
    });
    if constexpr (length <= 16) {
      Lanes<T, w> own[length][pieces];
      for_constants<length>([&](auto k)
                                DALEMBERT_IN_BLOCK { load_rows<c, Path::at[decltype(k)::value]>(jacobian, acts, own[k]); });
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
        load_rows<c, Path::at[decltype(k)::value]>(jacobian, acts, own);
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
  DALEMBERT_INLINE void fill(const T* jacobian, const T* factor, const T* reciprocals, const T* active) const {
    for_constants<count>(
        [&](auto c) DALEMBERT_IN_BLOCK { fill_rows<decltype(c)::value>(jacobian, factor, active ? active[c] : T(1)); });
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
        const SharedPieces& both = Rows::shared.pieces[Rows::pair(a, b)];
        products<rows, padded, Into::set, T>(weighted + both.a[0] * padded, row(b, both.b[0]), both.size[0], of(a, b));
        for (int i = 1; i < both.count; ++i)
          products<rows, padded, Into::add, T>(weighted + both.a[i] * padded, row(b, both.b[i]), both.size[i], of(a, b));
      });
    });
  }
};

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
  using constraint_detail::each_index;
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

// x becomes M^-1 (x + J' f), and f what makes J x = b. factor: M's U, of which the half above the diagonal is read. right: b.
// active: 1 or 0 per constraint. regularization: R, per row.
template <int n, class Rows, class Tree, class T>
__attribute__((noinline)) static ConstraintStatus<T> solve_constrained(const T* jacobian, const T* factor, const T* pivots,
                                                                       const T* right, const T* active, const T* regularization,
                                                                       T* room, T* forces, T* x) noexcept {
  using Blocks = constraint_detail::ConstraintBlocks<n, Rows, T>;
  using constraint_detail::for_constants;
  using constraint_detail::Into;
  constexpr int count = Rows::count, rows = Blocks::rows, padded = Blocks::padded, w = Blocks::w;
  const Blocks blocks(room);
  T reciprocals[n];
  constraint_detail::reciprocals_of<n>(pivots, reciprocals);
  constraint_detail::eliminate_upwards<n, Tree>(factor, x);
  blocks.fill(jacobian, factor, reciprocals, active);

  // c, mu N, and the diagonal. What no row stands for is a one.
  constexpr int pieces = Blocks::pieces;
  using Row = constraint_detail::BlockRow<T, w, pieces>;
  using constraint_detail::each_index;
  Row known[count], held[count];
  T scaled[n], sum = T(0);
  for (int k = 0; k < n; ++k) scaled[k] = x[k] * reciprocals[k];
  each_index<count>([&](auto c) DALEMBERT_IN_BLOCK {
    for (int r = 0; r < Rows::rows[c]; ++r) sum += blocks.of(c, c)[r * padded + r];
  });
  each_index<count>([&](auto c) DALEMBERT_IN_BLOCK {
    const int own = Rows::rows[c], linear = Rows::linear[c];
    T* const block = blocks.of(c, c);
    alignas(64) T rest[padded] = {}, hold[padded] = {};
    T means[2] = {T(least_share) * sum, T(least_share) * sum};
    for (int r = 0; r < own; ++r)
      means[r < linear ? 0 : 1] += block[r * padded + r] * (T(1) / T(r < linear ? linear : own - linear));
    const bool acts = active[c] > T(0);
    for (int r = 0; r < rows; ++r) {
      const T mean = means[r < linear ? 0 : 1];
      hold[r] = acts && r < own ? Proximal<T>::of(block[r * padded + r]) * (mean > T(0) ? mean : T(1)) : T(0);
      rest[r] = acts && r < own ? right[Rows::first(c) + least(r, own - 1)] : T(0);
      block[r * padded + r] += acts && r < own ? hold[r] + regularization[Rows::first(c) + least(r, own - 1)] : T(1);
    }
    Row left = Row::load(rest);
    for (int k = 0; k < Rows::lengths[c]; ++k) left.template add<true>(scaled[Rows::paths[c][k]], blocks.row(c, k));
    known[c] = left;
    held[c] = Row::load(hold);
  });

  // Elimination of blocks, from the first; where they are few, what is eliminated is had both ways round.
  constexpr bool few = count <= 4;
  alignas(64) T both_ways[few ? (count * (count - 1) / 2 + 1) * Blocks::block : 1];
  const auto transposed = [&](int a, int b) { return both_ways + (blocks.eliminated(a, b) - blocks.scaled); };
  alignas(64) T block_pivots[count * padded];
  each_index<count>([&](auto c) DALEMBERT_IN_BLOCK {
    constraint_detail::invert_block<rows, padded, T>(blocks.of(c, c), block_pivots + c * padded);
    each_index<count>([&](auto b) DALEMBERT_IN_BLOCK {
      if (b <= c) return;
      constraint_detail::products<rows, padded, Into::set, T>(blocks.of(c, c), blocks.of(c, b), rows, blocks.eliminated(c, b));
      if constexpr (few)
        constraint_detail::products<rows, padded, Into::set, T>(blocks.of(c, b), blocks.of(c, c), rows, transposed(c, b));
    });
    each_index<count>([&](auto a) DALEMBERT_IN_BLOCK {
      if (a <= c) return;
      each_index<count>([&](auto b) DALEMBERT_IN_BLOCK {
        if (b < a) return;
        constraint_detail::products<rows, padded, Into::subtract, T>(blocks.of(c, a), blocks.eliminated(c, b), rows,
                                                                     blocks.of(a, b));
      });
    });
  });

  ConstraintStatus<T> status;
  each_index<count>([&](auto c) DALEMBERT_IN_BLOCK {
    if (!(active[c] > T(0))) return;
    alignas(64) T hold[padded];
    held[c].store(hold);
    for (int r = 0; r < Rows::rows[c]; ++r) {
      const T pivot = block_pivots[c * padded + r] * Proximal<T>::mu / hold[r];
      status.least_pivot = pivot < status.least_pivot ? pivot : status.least_pivot;
      status.rank += pivot > T(64) * Proximal<T>::mu ? 1 : 0;
    }
  });

  // Inverses of blocks are as wrong as their pivots are small. Then steps behind the first add what rows lack: an error of
  // theirs becomes one of the last addition.
  const bool refines = !(status.least_pivot > Proximal<T>::near);
  Row solved[count] = {}, before[count] = {};
  const auto pushed_by = [&](const Row(&with)[count], T(&to)[n]) DALEMBERT_IN_BLOCK {  // Y f, in lanes at first
    Row pushed[n] = {};
    each_index<count>([&](auto c) DALEMBERT_IN_BLOCK {
      for (int k = 0; k < Rows::lengths[c]; ++k) pushed[Rows::paths[c][k]].add(with[c], blocks.row(c, k));
    });
    for (int k = 0; k < n; ++k) to[k] = pushed[k].total();
  };
  for (int step = 0; step < Proximal<T>::steps; ++step) {
    Row rest[count];
    each_index<count>([&](auto c) DALEMBERT_IN_BLOCK {
      before[c] = solved[c];
      rest[c] = known[c].plus(held[c], solved[c]);
    });
    if (refines && step > 0) {
      T moved[n];
      pushed_by(solved, moved);
      for (int k = 0; k < n; ++k) moved[k] *= reciprocals[k];
      each_index<count>([&](auto c) DALEMBERT_IN_BLOCK {
        alignas(64) T gives[padded] = {};
        for (int r = 0; r < Rows::rows[c]; ++r) gives[r] = -regularization[Rows::first(c) + r];
        rest[c] = known[c].plus(Row::load(gives), solved[c]);
        for (int k = 0; k < Rows::lengths[c]; ++k) rest[c].template add<true>(moved[Rows::paths[c][k]], blocks.row(c, k));
      });
    }
    each_index<count>([&](auto c) DALEMBERT_IN_BLOCK {
      each_index<count>([&](auto b) DALEMBERT_IN_BLOCK {
        if (b > c) rest[b].template add_rows<true, rows>(rest[c], blocks.eliminated(c, b));
      });
      solved[c] = Row{};
      solved[c].template add_rows<false, rows>(rest[c], blocks.of(c, c));
    });
    each_index<count>([&](auto back) DALEMBERT_IN_BLOCK {
      const int c = count - 1 - back;
      each_index<count>([&](auto b) DALEMBERT_IN_BLOCK {
        if (b <= c) return;
        if constexpr (few) solved[c].template add_rows<true, rows>(solved[b], transposed(c, b));
        else solved[c].template subtract_products<rows>(solved[b], blocks.eliminated(c, b));
      });
    });
    if (refines) each_index<count>([&](auto c) DALEMBERT_IN_BLOCK { solved[c].add(before[c]); });
  }
  each_index<count>([&](auto c) DALEMBERT_IN_BLOCK {
    alignas(64) T now[padded], last[padded], hold[padded];
    solved[c].store(now), before[c].store(last), held[c].store(hold);
    const bool acts = active[c] > T(0);
    for (int r = 0; r < Rows::rows[c]; ++r) {
      forces[Rows::first(c) + r] = now[r];
      if (!acts) continue;
      const T change = now[r] - last[r], error = hold[r] * (change < T(0) ? -change : change);
      status.residual = error > status.residual ? error : status.residual;
    }
  });

  T pushed[n];
  pushed_by(solved, pushed);
  for (int k = 0; k < n; ++k) x[k] += pushed[k];
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

// Coordinates without a motor.
template <int... coordinates>
struct Undriven {
  static constexpr int count = sizeof...(coordinates);
  static constexpr int at[sizeof...(coordinates) + 1] = {coordinates..., 0};
};

// to becomes to - J' f, f = W J_u y being what makes it zero at the coordinates u that have no motor: of all such f the one
// with the least sum of f^2 / W. y is found by proximal steps as above, with N the diagonal of J_u' W J_u: what no constraint
// can bear stays, and is the residual.
template <int n, class Rows, class Without, class T>
__attribute__((noinline)) static ConstraintStatus<T> support(const T* jacobian, const T* active, const T* weights, T* forces,
                                                             T* to) noexcept {
  constexpr int all = Rows::first(Rows::count), u = Without::count, room = u > 0 ? u : 1;
  ConstraintStatus<T> status;
  T weight[all];
  for (int c = 0; c < Rows::count; ++c)
    for (int r = Rows::first(c); r < Rows::first(c + 1); ++r) {
      weight[r] = active[c] > T(0) ? weights[r] : T(0);
      forces[r] = T(0);
    }
  // J_u' W J_u = L D L', D's reciprocals on the diagonal.
  T weighted[room * all], L[room * room], held[room], y[room] = {};
  for (int i = 0; i < u; ++i) {
    const T* const column = jacobian + Without::at[i] * all;
    for (int r = 0; r < all; ++r) weighted[i * all + r] = weight[r] * column[r];
    for (int j = 0; j <= i; ++j) {
      const T* const other = weighted + j * all;
      T sum = T(0);
      for (int r = 0; r < all; ++r) sum += column[r] * other[r];
      L[i * room + j] = sum;
    }
    const T own = L[i * room + i];
    held[i] = Proximal<T>::mu * (own > T(0) ? own : T(1));
    L[i * room + i] = own + held[i];
  }
  for (int i = 0; i < u; ++i) {
    const T pivot = L[i * room + i], share = pivot * Proximal<T>::mu / held[i], reciprocal = T(1) / pivot;
    status.least_pivot = share < status.least_pivot ? share : status.least_pivot;
    status.rank += share > T(64) * Proximal<T>::mu ? 1 : 0;
    L[i * room + i] = reciprocal;
    for (int k = i + 1; k < u; ++k) {
      const T factor = L[k * room + i] * reciprocal;
      for (int j = i + 1; j <= k; ++j) L[k * room + j] -= factor * L[j * room + i];
    }
    for (int k = i + 1; k < u; ++k) L[k * room + i] *= reciprocal;
  }
  for (int step = 0; step < Proximal<T>::steps; ++step) {
    for (int i = 0; i < u; ++i) y[i] = to[Without::at[i]] + held[i] * y[i];
    for (int i = 0; i < u; ++i)
      for (int j = 0; j < i; ++j) y[i] -= L[i * room + j] * y[j];
    for (int i = u - 1; i >= 0; --i) {
      y[i] *= L[i * room + i];
      for (int k = i + 1; k < u; ++k) y[i] -= L[k * room + i] * y[k];
    }
  }
  for (int i = 0; i < u; ++i)
    for (int r = 0; r < all; ++r) forces[r] += weighted[i * all + r] * y[i];
  for (int c = 0; c < Rows::count; ++c)
    for (int k = 0; k < Rows::lengths[c]; ++k) {
      const int at = Rows::paths[c][k];
      T borne = T(0);
      for (int r = Rows::first(c); r < Rows::first(c + 1); ++r) borne += jacobian[at * all + r] * forces[r];
      to[at] -= borne;
    }
  for (int i = 0; i < u; ++i) {
    const T left = to[Without::at[i]], size = left < T(0) ? -left : left;
    status.residual = size > status.residual ? size : status.residual;
  }
  return status;
}

namespace constraint_detail {

// `columns` columns to(j) = base(j) more, or less, by the sum over k < count of factor(j, k) from(k): `pieces` registers of
// each from `begin` on. base: null where it is none.
template <int columns, int pieces, bool negative, class T, class Factor, class From, class Base, class To>
DALEMBERT_INLINE void sum_tile(int begin, int count, const Factor& factor, const From& from, const Base& base, const To& to) {
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
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { x[i] = load<w>(column + i * w); });
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
DALEMBERT_INLINE void sum_columns(int count, const Factor& factor, const From& from, const Base& base, const To& to) {
  constexpr int w = native_lanes, all = (size + w - 1) / w, at_once = least(all, columns == 1 ? 8 : columns == 2 ? 4 : 2);
  constexpr int rest = all % at_once;
  int begin = 0;
  for (; begin + at_once * w <= all * w; begin += at_once * w)
    sum_tile<columns, at_once, negative, T>(begin, count, factor, from, base, to);
  if constexpr (rest > 0) sum_tile<columns, rest, negative, T>(begin, count, factor, from, base, to);
}

// f(columns, first): six columns at a time, and those that are left.
template <int count, class F>
DALEMBERT_INLINE void in_sixes(const F& f) {
  for (int j = 0; j + 6 <= count; j += 6) f(std::integral_constant<int, 6>{}, j);
  if constexpr (count % 6 > 0) f(std::integral_constant<int, count % 6>{}, count - count % 6);
}

// A symmetric positive definite matrix of m rows of `padded` numbers becomes its inverse (Gauss and Jordan).
template <int m, int padded, class T>
DALEMBERT_INLINE void invert_rows(T* a) {
  constexpr int w = native_lanes, pieces = padded / w;
  for (int j = 0; j < m; ++j) {
    T* const own = a + j * padded;
    const T reciprocal = T(1) / own[j];
    const Lanes<T, w> times = broadcast<w, T>(reciprocal);
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { store<w, T>(own + i * w, load<w>(own + i * w) * times); });
    // Single numbers are written behind registers: what is read next has been there for long.
    const auto subtract = [&](int r) DALEMBERT_IN_BLOCK {
      T* const row = a + r * padded;
      const T factor = row[j];
      const Lanes<T, w> factors = broadcast<w, T>(factor);
      for_constants<pieces>(
          [&](auto i) DALEMBERT_IN_BLOCK { store<w, T>(row + i * w, load<w>(row + i * w) - factors * load<w>(own + i * w)); });
      row[j] = -factor * reciprocal;
    };
    for (int r = 0; r < j; ++r) subtract(r);
    for (int r = j + 1; r < m; ++r) subtract(r);
    own[j] = reciprocal;
  }
}

// Which constraints' rows know which coordinates.
template <int n, class Rows>
struct Known {
  struct Table {
    bool of[Rows::count][n] = {};
  };
  static constexpr Table table() {
    Table all;
    for (int c = 0; c < Rows::count; ++c)
      for (int i = 0; i < Rows::lengths[c]; ++i) all.of[c][Rows::paths[c][i]] = true;
    return all;
  }
  static constexpr Table value = table();
};

// Where what respond() makes stands in its room.
template <int n, class Rows, class T>
struct ResponseParts {
  static constexpr int m = Rows::first(Rows::count), padded = (m + native_lanes - 1) / native_lanes * native_lanes;
  static constexpr int stride = inverse_stride(n);
  static_assert(padded <= padded_rows(m), "the compiler makes room for registers of eight");
  T* const columns;               // B, a column of `stride` numbers per row of a constraint
  T* const rows;                  // the same, `padded` numbers per coordinate, where forces are asked for
  T* const along;                 // L, m times `padded` numbers
  T* const inverse;               // the inverse of J M^-1 J' + R + mu N, likewise
  T* const moved;                 // M^-1 J', as `columns`
  T* const acting;                // J' of what acts, constraint by constraint along its path
  T *const scaled, *const other;  // as `along`, on the way there

  explicit ResponseParts(T* room)
      : columns(room),
        rows(columns + stride * m),
        along(rows + n * padded),
        inverse(along + m * padded),
        moved(inverse + m * padded),
        acting(moved + stride * m),
        scaled(acting + n * m),
        other(scaled + m * padded) {}
};

}  // namespace constraint_detail

// projected = N, laid out as `inverse`, which is M^-1 as invert_chain() leaves it. room: response_room(n, rows) numbers.
// forces: whether theirs are asked for.
template <int n, class Rows, bool forces, class T>
__attribute__((noinline)) static void respond(const T* jacobian, const T* inverse, const T* active, const T* regularization,
                                              T* room, T* projected) noexcept {
  using constraint_detail::for_constants;
  using constraint_detail::in_sixes;
  using constraint_detail::sum_columns;
  using Parts = constraint_detail::ResponseParts<n, Rows, T>;
  constexpr int m = Parts::m, padded = Parts::padded, stride = Parts::stride;
  const Parts parts(room);
  const auto none = [](int) -> const T* { return nullptr; };

  // M^-1 J', and, a row per coordinate, J M^-1 J' + R + mu N, as solve_constrained() has it.
  T* const turned = parts.rows;
  for_constants<Rows::count>([&](auto constraint) DALEMBERT_IN_BLOCK {
    constexpr int c = decltype(constraint)::value, first = Rows::first(c);
    using Path = typename Rows::template path<c>;
    T* const own = parts.acting + first * n;
    for (int k = 0; k < Path::length; ++k)
      for (int r = 0; r < Path::rows; ++r) {
        const T x = jacobian[Path::at[k] * m + first + r];
        own[k * Path::rows + r] = (x <= Proximal<T>::unmoved && x >= -Proximal<T>::unmoved ? T(0) : x) * active[c];
      }
    sum_columns<Path::rows, n, false, T>(
        Path::length, [&](int r, int k) { return own[k * Path::rows + r]; },
        [&](int k) { return inverse + Path::at[k] * stride; }, none, [&](int r) { return parts.moved + (first + r) * stride; });
    for (int r = first; r < first + Path::rows; ++r)
      for (int i = 0; i < n; ++i) turned[i * padded + r] = parts.moved[r * stride + i];
  });
  for (int i = 0; m < padded && i < n; ++i)
    for (int r = m; r < padded; ++r) turned[i * padded + r] = T(0);
  for_constants<Rows::count>([&](auto constraint) DALEMBERT_IN_BLOCK {
    constexpr int c = decltype(constraint)::value, first = Rows::first(c);
    using Path = typename Rows::template path<c>;
    const T* const own = parts.acting + first * n;
    sum_columns<Path::rows, padded, false, T>(
        Path::length, [&](int r, int k) { return own[k * Path::rows + r]; },
        [&](int k) { return turned + Path::at[k] * padded; }, none,
        [&](int r) { return parts.inverse + (first + r) * padded; });
  });
  T held[m], sum = T(0);
  for (int r = 0; r < m; ++r) sum += parts.inverse[r * padded + r];
  for (int c = 0; c < Rows::count; ++c) {
    const int first = Rows::first(c), own = Rows::rows[c], linear = Rows::linear[c];
    T means[2] = {T(least_share) * sum, T(least_share) * sum};
    for (int r = 0; r < own; ++r)
      means[r < linear ? 0 : 1] +=
          parts.inverse[(first + r) * padded + first + r] * (T(1) / T(r < linear ? linear : own - linear));
    for (int r = 0; r < own; ++r) {
      const T mean = means[r < linear ? 0 : 1];
      const T along = parts.inverse[(first + r) * padded + first + r];
      held[first + r] = active[c] > T(0) ? Proximal<T>::of(along) * (mean > T(0) ? mean : T(1)) : T(0);
      parts.inverse[(first + r) * padded + first + r] += active[c] > T(0) ? held[first + r] + regularization[first + r] : T(1);
    }
  }
  constraint_detail::invert_rows<m, padded>(parts.inverse);
  // L = X + X mu N L, X the inverse, a few times over; at first X.
  const auto row_of = [&](T* rows, int first) { return [=](int r) { return rows + (first + r) * padded; }; };
  const T* last = parts.inverse;
  for (int step = 1; step < Proximal<T>::steps; ++step) {
    T* const next = (Proximal<T>::steps - step) % 2 == 1 ? parts.along : parts.other;
    for (int r = 0; r < m; ++r)
      for (int i = 0; i < padded; ++i) parts.scaled[r * padded + i] = held[r] * last[r * padded + i];
    in_sixes<m>([&](auto columns, int first) DALEMBERT_IN_BLOCK {
      sum_columns<decltype(columns)::value, padded, false, T>(
          m, [&](int r, int k) { return parts.inverse[(first + r) * padded + k]; },
          [&](int k) { return parts.scaled + k * padded; }, row_of(parts.inverse, first), row_of(next, first));
    });
    last = next;
  }
  static_assert(Proximal<T>::steps > 1, "the last of them is L");
  for (int c = 0; c < Rows::count; ++c)
    if (!(active[c] > T(0)))
      for (int r = Rows::first(c); r < Rows::first(c + 1); ++r) parts.along[r * padded + r] = T(0);

  const auto column_of = [&](T* columns, int first) { return [=](int r) { return columns + (first + r) * stride; }; };
  in_sixes<m>([&](auto columns, int first) DALEMBERT_IN_BLOCK {
    sum_columns<decltype(columns)::value, n, false, T>(
        m, [&](int r, int k) { return parts.along[(first + r) * padded + k]; }, [&](int k) { return parts.moved + k * stride; },
        none, column_of(parts.columns, first));
  });
  if constexpr (forces)
    for (int r = 0; r < m; ++r)
      for (int i = 0; i < n; ++i) parts.rows[i * padded + r] = parts.columns[r * stride + i];
  in_sixes<n>([&](auto columns, int first) DALEMBERT_IN_BLOCK {
    sum_columns<decltype(columns)::value, n, true, T>(
        m, [&](int j, int k) { return parts.moved[k * stride + first + j]; }, [&](int k) { return parts.columns + k * stride; },
        [&](int j) { return inverse + (first + j) * stride; }, column_of(projected, first));
  });
}

// df/dtau = -B'.
template <int n, class Rows, class T>
static inline void response_of_forces(const T* room, T* to) noexcept {
  using Parts = constraint_detail::ResponseParts<n, Rows, const T>;
  const Parts parts(room);
  for (int k = 0; k < n; ++k)
    for (int r = 0; r < Parts::m; ++r) to[k * Parts::m + r] = -parts.rows[k * Parts::padded + r];
}

// to, which is -N efforts from column `first` on, becomes -N efforts - B changes: n x n. changes: rows x n, zero where no
// constraint knows the coordinate.
template <int n, class Rows, class T>
__attribute__((noinline)) static void derive_accelerations(int first, const T* changes, const T* room, T* to) noexcept {
  using Parts = constraint_detail::ResponseParts<n, Rows, const T>;
  constexpr int m = Parts::m, stride = Parts::stride;
  const Parts parts(room);
  for (int k = 0; k < n; ++k) {
    // Rows that know it, from the first of them to the last.
    int begin = m, end = 0;
    for (int c = 0; c < Rows::count; ++c)
      if (constraint_detail::Known<n, Rows>::value.of[c][k]) {
        begin = least(begin, Rows::first(c));
        end = Rows::first(c + 1);
      }
    T* const own = to + k * n;
    if (begin >= end) {
      for (int i = 0; k < first && i < n; ++i) own[i] = T(0);
      continue;
    }
    alignas(64) T column[stride];
    constraint_detail::sum_columns<1, n, true, T>(
        end - begin, [&](int, int r) { return changes[k * m + begin + r]; },
        [&](int r) { return parts.columns + (begin + r) * stride; }, [](int) -> const T* { return nullptr; },
        [&](int) { return column; });
    for (int i = 0; i < n; ++i) own[i] = k < first ? column[i] : own[i] + column[i];
  }
}

// to = B' efforts - L changes: rows x n.
template <int n, class Rows, class T>
__attribute__((noinline)) static void derive_forces(const T* efforts, const T* changes, const T* room, T* to) noexcept {
  using Parts = constraint_detail::ResponseParts<n, Rows, const T>;
  constexpr int m = Parts::m, padded = Parts::padded;
  const Parts parts(room);
  constraint_detail::in_sixes<n>([&](auto columns, int first) DALEMBERT_IN_BLOCK {
    constexpr int count = decltype(columns)::value;
    alignas(64) T column[count * padded];
    const auto own = [&](int j) { return column + j * padded; };
    constraint_detail::sum_columns<count, padded, false, T>(
        n, [&](int j, int k) { return efforts[(first + j) * n + k]; }, [&](int k) { return parts.rows + k * padded; },
        [](int) -> const T* { return nullptr; }, own);
    constraint_detail::sum_columns<count, padded, true, T>(
        m, [&](int j, int r) { return changes[(first + j) * m + r]; }, [&](int r) { return parts.along + r * padded; }, own,
        own);
    for (int j = 0; j < count; ++j)
      for (int r = 0; r < m; ++r) to[(first + j) * m + r] = column[j * padded + r];
  });
}

// Where the forces of loops turn with one link and move with another, efforts are more by left' right, both `more` x n: what
// the two derivatives have more of it. Either may be null. turning: turning_room(n, rows, more) numbers.
template <int n, class Rows, int more, class T>
__attribute__((noinline)) static void derive_turning(const T* left, const T* right, const T* projected, const T* room,
                                                     T* turning, T* accelerations, T* forces) noexcept {
  using constraint_detail::in_sixes;
  using constraint_detail::sum_columns;
  using Parts = constraint_detail::ResponseParts<n, Rows, const T>;
  constexpr int m = Parts::m, padded = Parts::padded, stride = Parts::stride;
  const Parts parts(room);
  T* const of_forces = turning + more * stride;
  const auto none = [](int) -> const T* { return nullptr; };
  in_sixes<more>([&](auto columns, int first) DALEMBERT_IN_BLOCK {
    constexpr int count = decltype(columns)::value;
    const auto factor = [&](int i, int k) { return left[k * more + first + i]; };
    sum_columns<count, n, false, T>(
        n, factor, [&](int k) { return projected + k * stride; }, none, [&](int i) { return turning + (first + i) * stride; });
    if (forces)
      sum_columns<count, padded, false, T>(
          n, factor, [&](int k) { return parts.rows + k * padded; }, none,
          [&](int i) { return of_forces + (first + i) * padded; });
  });
  for (int k = 0; k < n; ++k) {
    const auto factor = [&](int, int i) { return right[k * more + i]; };
    alignas(64) T column[stride > padded ? stride : padded];
    const auto own = [&](int) { return column; };
    if (accelerations) {
      sum_columns<1, n, true, T>(
          more, factor, [&](int i) { return turning + i * stride; }, none, own);
      for (int i = 0; i < n; ++i) accelerations[k * n + i] += column[i];
    }
    if (forces) {
      sum_columns<1, padded, false, T>(
          more, factor, [&](int i) { return of_forces + i * padded; }, none, own);
      for (int r = 0; r < m; ++r) forces[k * m + r] += column[r];
    }
  }
}

}  // namespace dalembert
