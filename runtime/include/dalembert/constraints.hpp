// Accelerations that keep to constraints: M dv = e + J' f, J dv = b, with M's factors along the tree, M = U D U' (factor.hpp,
// solve.hpp).
//
// Y = U^-1 J' is made constraint by constraint, along the coordinates above its body alone (Featherstone 2008, section 6.5); then
// J M^-1 J' = Y' D^-1 Y, in which two constraints meet where coordinates stand above both. Rows that say the same twice, or ask
// for what no joint can do, make it singular: it is solved by the proximal point method (Carpentier, Budhiraja and Mansard 2021),
//
//   (Y' D^-1 Y + R + mu N) f' = c + mu N f,   f = 0 at first,
//
// a fixed number of times. N is the mean inverse inertia along a block's three rows. A constraint that does not act has rows of
// zeros, a one on its diagonal and nothing on the right: its forces are zero, and nobody else's numbers change.
//
// Nothing allocates; loops depend on the robot and its constraints alone.
#pragma once

#include <dalembert/constraint_shapes.hpp>
#include <dalembert/solve.hpp>

namespace dalembert {

// What solving for constraints came to.
template <class T>
struct ConstraintStatus {
  T residual = T(0);     // the largest error that is left of a row that acts, m/s^2 or rad/s^2; of an impact, m/s or rad/s
  T least_pivot = T(1);  // the least pivot, in terms of N; at most 1: near mu where rows say what others say
  int rank = 0;          // how many rows that act say something new
};

// Where constraints stand on the tree.
struct ConstraintPaths {
  const int* first;       // row of each, and behind the last how many there are
  const int* path;        // the coordinates above the body of each, the tree's root first; one list behind another
  const int* path_begin;  // where each list begins, and behind the last its end
};

namespace detail {

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

// to[r][s] += the sum over k of a[k][r] b[k][s], as many rows of a block as say something, or less it. a and b: `count` times
// `padded` numbers.
template <int rows, int padded, bool negative, class T>
DALEMBERT_INLINE void add_products(const T* a, const T* b, int count, T* to) {
  constexpr int w = lanes_in_block(padded), pieces = padded / w;
  Lanes<T, w> sum[rows][pieces];
  for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { sum[r][i] = load<w>(to + r * padded + i * w); });
  });
  DALEMBERT_KEEP_LOOP
  for (int k = 0; k < count; ++k) {
    Lanes<T, w> row[pieces];
    for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { row[i] = load<w>(b + k * padded + i * w); });
    for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
      const Lanes<T, w> factor = broadcast<w, T>(a[k * padded + r]);
      for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
        if constexpr (negative) sum[r][i] -= factor * row[i];
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

// Of two constraints, how many coordinates stand above both.
static inline int shared_path(const ConstraintPaths& at, int a, int b) noexcept {
  const int *of_a = at.path + at.path_begin[a], *of_b = at.path + at.path_begin[b];
  const int most = least(at.path_begin[a + 1] - at.path_begin[a], at.path_begin[b + 1] - at.path_begin[b]);
  int shared = 0;
  while (shared < most && of_a[shared] == of_b[shared]) ++shared;
  return shared;
}

// What is solved in. rows: of a block.
template <int n, int count, int rows, int longest, class T>
struct ConstraintBlocks {
  static constexpr int padded = block_lanes(rows), block = rows * padded;
  T* const y;         // count x longest x padded
  T* const inertia;   // of each constraint with itself and those behind it
  T* const scaled;    // of each with those behind it: eliminated

  explicit ConstraintBlocks(T* room)
      : y(room), inertia(y + count * longest * padded), scaled(inertia + count * (count + 1) / 2 * block) {}
  T* row(int c, int k) const { return y + (c * longest + k) * padded; }
  // b is not before a.
  T* of(int a, int b) const { return inertia + (a * count - a * (a - 1) / 2 + b - a) * block; }
  T* eliminated(int a, int b) const { return scaled + (a * (count - 1) - a * (a - 1) / 2 + b - a - 1) * block; }

  // Y = U^-1 J', of constraints that do not act zero, and Y' D^-1 Y.
  void fill(const ConstraintPaths& at, const T* jacobian, const T* factor, const T* reciprocals, const T* active) const noexcept {
    constexpr int w = lanes_in_block(padded), pieces = padded / w;
    const int all = at.first[count];
    for (int c = 0; c < count; ++c) {
      const int first = at.first[c], own = at.first[c + 1] - first;
      const int *const path = at.path + at.path_begin[c], length = at.path_begin[c + 1] - at.path_begin[c];
      const T acts = active ? active[c] : T(1);
      for (int k = 0; k < length; ++k) {
        T* const to = row(c, k);
        const T* const from = jacobian + path[k] * all + first;
        for (int r = 0; r < padded; ++r) to[r] = r < own ? acts * from[r] : T(0);
      }
      for (int k = length - 1; k > 0; --k) {
        const T* const column = factor + path[k] * n;
        Lanes<T, w> below[pieces];
        for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK { below[i] = load<w>(row(c, k) + i * w); });
        for (int above = 0; above < k; ++above) {
          const Lanes<T, w> times = broadcast<w, T>(column[path[above]]);
          T* const to = row(c, above);
          for_constants<pieces>(
              [&](auto i) DALEMBERT_IN_BLOCK { store<w, T>(to + i * w, load<w>(to + i * w) - times * below[i]); });
        }
      }
    }
    for (int a = 0; a < count; ++a) {
      const int* const path = at.path + at.path_begin[a];
      T weighted[longest * padded];
      for (int k = 0; k < at.path_begin[a + 1] - at.path_begin[a]; ++k)
        for_constants<pieces>([&](auto i) DALEMBERT_IN_BLOCK {
          store<w, T>(weighted + k * padded + i * w, broadcast<w, T>(reciprocals[path[k]]) * load<w>(row(a, k) + i * w));
        });
      for (int b = a; b < count; ++b) {
        for (int i = 0; i < block; ++i) of(a, b)[i] = T(0);
        add_products<rows, padded, false, T>(weighted, row(b, 0), shared_path(at, a, b), of(a, b));
      }
    }
  }
};

// x = U^-1 x, without a register of lanes that has but one number to bear.
template <int n, class T>
DALEMBERT_INLINE void eliminate_upwards(const Chains& chains, const T* factor, T* x) {
  for (int c = chains.count - 1; c >= 0; --c) {
    const int first = chains.begin[c], end = chains.begin[c + 1];
    for (int k = end - 1; k > first; --k)
      for (int i = first; i < k; ++i) x[i] -= factor[k * n + i] * x[k];
    each_above(chains, c, [&](int begin, int behind, int) DALEMBERT_IN_BLOCK {
      for (int k = end - 1; k >= first; --k)
        for (int i = begin; i < behind; ++i) x[i] -= factor[k * n + i] * x[k];
    });
  }
}

// x = U'^-1 D^-1 x.
template <int n, class T>
DALEMBERT_INLINE void substitute_downwards(const Chains& chains, const T* factor, const T* reciprocals, T* x) {
  for (int c = 0; c < chains.count; ++c) {
    const int first = chains.begin[c], end = chains.begin[c + 1];
    T rest[longest_chain];
    for (int k = first; k < end; ++k) rest[k - first] = x[k] * reciprocals[k];
    each_above(chains, c, [&](int begin, int behind, int) DALEMBERT_IN_BLOCK {
      for (int i = begin; i < behind; ++i)
        for (int k = first; k < end; ++k) rest[k - first] -= factor[k * n + i] * x[i];
    });
    for (int k = first; k < end; ++k) {
      T own = rest[k - first];
      for (int i = first; i < k; ++i) own -= factor[k * n + i] * x[i];
      x[k] = own;
    }
  }
}

template <int n, class T>
DALEMBERT_INLINE void reciprocals_of(const T* pivots, T* reciprocals) {
  for (int k = 0; k < n; ++k) reciprocals[k] = T(1) / pivots[k];
}

}  // namespace detail

// to = J M^-1 J', all rows of all constraints, whether they act or not.
template <int n, int count, int rows, int longest, class T>
__attribute__((noinline)) static void delassus(const ConstraintPaths& at, const T* jacobian, const T* factor, const T* pivots,
                                               T* room, T* to) noexcept {
  const detail::ConstraintBlocks<n, count, rows, longest, T> blocks(room);
  T reciprocals[n];
  detail::reciprocals_of<n>(pivots, reciprocals);
  blocks.fill(at, jacobian, factor, reciprocals, static_cast<const T*>(nullptr));
  const int all = at.first[count];
  for (int a = 0; a < count; ++a)
    for (int b = a; b < count; ++b)
      for (int r = 0; r < at.first[a + 1] - at.first[a]; ++r)
        for (int s = 0; s < at.first[b + 1] - at.first[b]; ++s) {
          const T x = blocks.of(a, b)[r * blocks.padded + s];
          to[(at.first[b] + s) * all + at.first[a] + r] = x;
          to[(at.first[a] + r) * all + at.first[b] + s] = x;
        }
}

// x becomes M^-1 (x + J' f), and f what makes J x = b. factor: M's U, of which the half above the diagonal is read. right: b. active: 1 or 0 per constraint. regularization: R, per row.
template <int n, int count, int rows, int longest, class T>
__attribute__((noinline)) static ConstraintStatus<T> solve_constrained(const ConstraintPaths& at, const Chains& chains,
                                                                       const T* jacobian, const T* factor, const T* pivots,
                                                                       const T* right, const T* active, const T* regularization,
                                                                       T* room, T* forces, T* x) noexcept {
  using Blocks = detail::ConstraintBlocks<n, count, rows, longest, T>;
  constexpr int padded = Blocks::padded, all = count * padded;
  const Blocks blocks(room);
  T reciprocals[n];
  detail::reciprocals_of<n>(pivots, reciprocals);
  detail::eliminate_upwards<n>(chains, factor, x);
  blocks.fill(at, jacobian, factor, reciprocals, active);

  // c, mu N, and the diagonal. What no row stands for is a one.
  T known[all] = {}, held[all] = {}, sum = T(0);
  for (int c = 0; c < count; ++c) {
    const T* const own = blocks.of(c, c);
    for (int r = 0; r < rows; ++r) sum += own[r * padded + r];
  }
  for (int c = 0; c < count; ++c) {
    const int first = at.first[c], own = at.first[c + 1] - first;
    T* const block = blocks.of(c, c);
    for (int three = 0; three < rows; three += 3) {
      T mean = T(least_share) * sum;
      for (int r = three; r < three + 3; ++r) mean += block[r * padded + r] / T(3);
      mean = mean > T(0) ? mean : T(1);
      for (int r = three; r < three + 3; ++r) {
        const bool acts = r < own && active[c] > T(0);
        const int i = c * padded + r;
        held[i] = acts ? Proximal<T>::mu * mean : T(0);
        known[i] = acts ? right[first + r] : T(0);
        block[r * padded + r] += acts ? held[i] + regularization[first + r] : T(1);
      }
    }
    const int* const path = at.path + at.path_begin[c];
    for (int k = 0; k < at.path_begin[c + 1] - at.path_begin[c]; ++k) {
      const T rate = x[path[k]] * reciprocals[path[k]];
      for (int r = 0; r < padded; ++r) known[c * padded + r] -= rate * blocks.row(c, k)[r];
    }
  }

  // Elimination of blocks, from the first.
  T block_pivots[all] = {};
  for (int c = 0; c < count; ++c) {
    detail::invert_block<rows, padded, T>(blocks.of(c, c), block_pivots + c * padded);
    for (int b = c + 1; b < count; ++b) {
      T* const to = blocks.eliminated(c, b);
      for (int i = 0; i < Blocks::block; ++i) to[i] = T(0);
      detail::add_products<rows, padded, false, T>(blocks.of(c, c), blocks.of(c, b), rows, to);
    }
    for (int a = c + 1; a < count; ++a)
      for (int b = a; b < count; ++b)
        detail::add_products<rows, padded, true, T>(blocks.of(c, a), blocks.eliminated(c, b), rows, blocks.of(a, b));
  }

  ConstraintStatus<T> status;
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
        detail::add_rows<rows, padded, true, T>(blocks.eliminated(c, b), rest + c * padded, rest + b * padded);
      detail::add_rows<rows, padded, false, T>(blocks.of(c, c), rest + c * padded, solved + c * padded);
    }
    for (int c = count - 2; c >= 0; --c)
      for (int b = c + 1; b < count; ++b)
        for (int r = 0; r < rows; ++r)
          solved[c * padded + r] -= detail::block_dot<padded, T>(blocks.eliminated(c, b) + r * padded, solved + b * padded);
  }
  for (int c = 0; c < count; ++c)
    for (int r = 0; r < at.first[c + 1] - at.first[c]; ++r) {
      const int i = c * padded + r;
      forces[at.first[c] + r] = solved[i];
      if (held[i] == T(0)) continue;
      const T change = solved[i] - before[i], error = held[i] * (change < T(0) ? -change : change);
      const T pivot = block_pivots[i] * Proximal<T>::mu / held[i];
      status.residual = error > status.residual ? error : status.residual;
      status.least_pivot = pivot < status.least_pivot ? pivot : status.least_pivot;
      status.rank += pivot > T(64) * Proximal<T>::mu ? 1 : 0;
    }

  for (int c = 0; c < count; ++c) {
    const int* const path = at.path + at.path_begin[c];
    for (int k = 0; k < at.path_begin[c + 1] - at.path_begin[c]; ++k)
      x[path[k]] += detail::block_dot<padded, T>(blocks.row(c, k), solved + c * padded);
  }
  detail::substitute_downwards<n>(chains, factor, reciprocals, x);
  return status;
}

// v after an impact: to = v + M^-1 J' f, f being the impulses that change J v by `right`.
template <int n, int count, int rows, int longest, class T>
static inline ConstraintStatus<T> solve_impact(const ConstraintPaths& at, const Chains& chains, const T* jacobian, const T* factor,
                                               const T* pivots, const T* right, const T* active, const T* regularization,
                                               T* room, T* impulses, const T* v, T* to) noexcept {
  for (int k = 0; k < n; ++k) to[k] = T(0);
  const ConstraintStatus<T> status = solve_constrained<n, count, rows, longest>(at, chains, jacobian, factor, pivots, right,
                                                                                active, regularization, room, impulses, to);
  for (int k = 0; k < n; ++k) to[k] += v[k];
  return status;
}

}  // namespace dalembert
