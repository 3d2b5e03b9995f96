// What contacts and loops bear in inverse dynamics: forces that leave nothing to do for coordinates without a motor, the least
// of all such by their weights. Nothing allocates; loops depend on the robot and its constraints alone.
#pragma once

#include <cmath>
#include <dalembert/constraint_blocks.hpp>
#include <dalembert/constraint_limbs.hpp>
#include <dalembert/constraint_shapes.hpp>
#include <dalembert/constraints_beside.hpp>

namespace dalembert {

// Joints' axes for what constraints bear: of the coordinates above them but for the base's, in the order in which constraints
// name them, six numbers each.
template <class T>
struct AxesInArray {
  static constexpr bool in_slots = false;
  const T* axes;
  typename LimbsInArrays<T>::Joint joint(int place, int) const { return {nullptr, axes + 6 * place}; }
};

// Coordinates without a motor, `own_base` of them the base's.
template <int own_base, int... coordinates>
struct Undriven {
  static constexpr int count = sizeof...(coordinates), base = own_base;
  DALEMBERT_TABLE int at[sizeof...(coordinates) + 1] = {coordinates..., 0};
};

namespace constraint_detail {

// The weights of rows that act with zeros for those that are none (negative, infinite, no numbers), and a power of two that
// takes the largest next to one; zeros of other rows. Returns whether there was none such.
template <class Rows, class T>
__attribute__((noinline, cold)) static bool mend_weights(const T* active, const T* weights, T* to) noexcept {
  constexpr int all = Rows::first(Rows::count);
  T most = T(0);
  bool are_weights = true;
  for (int c = 0; c < Rows::count; ++c)
    for (int r = Rows::first(c); r < Rows::first(c + 1); ++r) {
      const T given = active[c] > T(0) ? weights[r] : T(0);
      const bool is_weight = given >= T(0) && given <= Proximal<T>::largest;
      to[r] = is_weight ? given : T(0);
      are_weights = are_weights && is_weight;
      most = to[r] > most ? to[r] : most;
    }
  int exponent = 0;
  std::frexp(most, &exponent);
  for (int r = 0; r < all; ++r) to[r] = std::ldexp(to[r], -exponent);
  return are_weights;
}

// Whether weights of rows that act are such that no product of them is infinite or lost, and none is negative by more than
// rounding beside others. Nobody waits for the answer.
template <class Rows, class T>
static DALEMBERT_INLINE bool are_ordinary(const T* active, const T* weights) {
  constexpr int all = Rows::first(Rows::count);
  T sum = T(0), size = T(0);  // the same, unless one is negative or no number
  each_piece<all>([&](auto lanes, auto at) DALEMBERT_IN_BLOCK {
    constexpr int w = decltype(lanes)::value, from = decltype(at)::value;
    using Row = BlockRow<T, w, 1>;
    const Lanes<T, w> given = load<w>(weights + from),
                      acts = each_lane<w, T>([&](int lane) { return active[Rows::of_row(from + lane)]; }),
                      weight = acts > Lanes<T, w>{} ? given : Lanes<T, w>{};
    sum += Row{{weight}}.total();
    size += Row{{weight < Lanes<T, w>{} ? -weight : weight}}.total();
  });
  // With squares of levers and mu, and two of these multiplied (invert_three), they have to be numbers still.
  constexpr T most = sizeof(T) == 8 ? T(1e100) : T(1e4), least = T(1) / most;
  return sum == size && sum <= most && (sum >= least || sum == T(0));
}

// Weights to go on with. Forces depend on their ratios alone: ordinary ones are taken as they are, others are mended. A row
// whose weight is none bears nothing.
template <class Rows, class T>
struct Weights {
  const T* of;
  bool are_weights = true;
  T mended[Rows::first(Rows::count)];

  DALEMBERT_INLINE Weights(const T* active, const T* weights) : of(weights) {
    if (__builtin_expect(are_ordinary<Rows>(active, weights), 1)) return;
    are_weights = mend_weights<Rows>(active, weights, mended);
    of = mended;
  }
  Weights(const Weights&) = delete;
  Weights& operator=(const Weights&) = delete;
};

// mu N of A's coordinates: N is the mean of A's diagonal over the base's first three, along its axes, and over the three that
// turn it, whichever way the base stands; of any other its own.
template <int u, int base, class T, class Diagonal>
static DALEMBERT_INLINE void hold(const Diagonal& diagonal, T* held) {
  const auto of = [](T N) { return Proximal<T>::mu * (N > Proximal<T>::least ? N : T(1)); };
  for (int i = 0; i < base; i += 3)
    held[i] = held[i + 1] = held[i + 2] = of((diagonal(i) + diagonal(i + 1) + diagonal(i + 2)) * T(1.0 / 3));
  for (int i = base; i < u; ++i) held[i] = of(diagonal(i));
}

// y of (A + mu N) y = to + mu N y, a few times over. solve: y by (A + mu N)^-1 of what it is given.
template <int u, class T, class Solve>
static DALEMBERT_INLINE void approach(const T (&held)[u], const T (&to)[u], T (&y)[u], const Solve& solve) {
  solve(to);
  for_constants<Proximal<T>::steps - 1>([&](auto) DALEMBERT_IN_BLOCK {
    T right[u];
    for_constants<u>([&](auto i) DALEMBERT_IN_BLOCK { right[i] = to[i] + held[i] * y[i]; });
    solve(right);
  });
}

// That y, and how much of it rows can bear. Of A the half below the diagonal is read and spoilt.
template <int u, class T>
static DALEMBERT_INLINE void solve_support(T (&a)[u][u], const T (&held)[u], const T (&to)[u], T (&y)[u],
                                           ConstraintStatus<T>& status) {
  T inverse[u][u];
  for_constants<u>([&](auto i) DALEMBERT_IN_BLOCK { a[i][i] += held[i]; });
  invert_few(a, inverse);
  Redundancy<T> redundancy;
  for_constants<u>([&](auto i) DALEMBERT_IN_BLOCK { redundancy.add(held[i] * inverse[i][i]); });
  redundancy.tell(u, status);
  approach(held, to, y, [&](const T(&right)[u]) DALEMBERT_IN_BLOCK {
    for_constants<u>([&](auto i) DALEMBERT_IN_BLOCK {
      T sums[2] = {};
      for_constants<u>([&](auto j) DALEMBERT_IN_BLOCK { sums[j % 2] += inverse[i][j] * right[j]; });
      y[i] = sums[0] + sums[1];
    });
  });
}
// The inverse of a, positive definite; its half below the diagonal is read.
template <class T>
static DALEMBERT_INLINE void invert_three(const T (&a)[3][3], T (&to)[3][3]) {
  const T first = T(1) / a[0][0], x = a[1][0] * first, y = a[2][0] * first;
  const T b = a[1][1] - x * a[1][0], c = a[2][1] - y * a[1][0], d = a[2][2] - y * a[2][0];
  const T of_rest = T(1) / (b * d - c * c), cx = c * x, cy = c * y;
  const T u = d * x - cy, v = b * y - cx;
  to[1][1] = d * of_rest, to[2][2] = b * of_rest, to[2][1] = to[1][2] = -(c * of_rest);
  to[1][0] = to[0][1] = -(u * of_rest), to[2][0] = to[0][2] = -(v * of_rest);
  to[0][0] = first + (u * x + v * y) * of_rest;
}
// The same of a base along the world's axes: forces have nothing to do with each other, nor with moments about their own axes.
template <class T>
static DALEMBERT_INLINE void solve_support_of_base(const T (&a)[6][6], const T (&held)[6], const T (&to)[6], T (&y)[6],
                                                   ConstraintStatus<T>& status) {
  T of_force[3], lever[3][3], rest[3][3], inverse[3][3];
  const auto others = [](auto i, const auto& f) DALEMBERT_IN_BLOCK {
    f(std::integral_constant<int, (decltype(i)::value + 1) % 3>{});
    f(std::integral_constant<int, (decltype(i)::value + 2) % 3>{});
  };
  for_constants<3>([&](auto i) DALEMBERT_IN_BLOCK {
    of_force[i] = T(1) / (a[i][i] + held[i]);
    others(i, [&](auto k) DALEMBERT_IN_BLOCK { lever[k][i] = a[3 + k][i] * of_force[i]; });
  });
  for_constants<3>([&](auto k) DALEMBERT_IN_BLOCK {
    for_constants<decltype(k)::value + 1>([&](auto l) DALEMBERT_IN_BLOCK {
      T own = a[3 + k][3 + l];
      if (k == l) own += held[3 + k];
      others(k, [&](auto i) DALEMBERT_IN_BLOCK {
        if (i != l) own -= lever[k][i] * a[3 + l][i];
      });
      rest[k][l] = own;
    });
  });
  invert_three(rest, inverse);
  Redundancy<T> redundancy;
  for_constants<3>([&](auto i) DALEMBERT_IN_BLOCK {
    constexpr int next = (decltype(i)::value + 1) % 3, last = (decltype(i)::value + 2) % 3;
    const T along = inverse[next][next] * lever[next][i] + inverse[next][last] * lever[last][i],
            across = inverse[last][next] * lever[next][i] + inverse[last][last] * lever[last][i];
    redundancy.add(held[i] * (of_force[i] + lever[next][i] * along + lever[last][i] * across));
    redundancy.add(held[3 + i] * inverse[i][i]);
  });
  redundancy.tell(6, status);
  approach(held, to, y, [&](const T(&right)[6]) DALEMBERT_IN_BLOCK {
    T moment[3];
    for_constants<3>([&](auto k) DALEMBERT_IN_BLOCK {
      moment[k] = right[3 + k];
      others(k, [&](auto i) DALEMBERT_IN_BLOCK { moment[k] -= lever[k][i] * right[i]; });
    });
    for_constants<3>([&](auto k) DALEMBERT_IN_BLOCK {
      y[3 + k] = inverse[k][0] * moment[0] + inverse[k][1] * moment[1] + inverse[k][2] * moment[2];
    });
    for_constants<3>([&](auto i) DALEMBERT_IN_BLOCK {
      y[i] = of_force[i] * right[i];
      others(i, [&](auto k) DALEMBERT_IN_BLOCK { y[i] -= lever[k][i] * y[3 + k]; });
    });
  });
}
// The same of many coordinates.
template <int u, class T>
static DALEMBERT_INLINE void solve_support_in_loops(T (&L)[u][u], const T (&held)[u], const T (&to)[u], T (&y)[u],
                                                    ConstraintStatus<T>& status) {
  for (int i = 0; i < u; ++i) L[i][i] += held[i], y[i] = T(0);
  for (int i = 0; i < u; ++i) {  // D's reciprocals on the diagonal
    const T reciprocal = L[i][i] = T(1) / L[i][i];
    for (int k = i + 1; k < u; ++k) {
      const T factor = L[k][i] * reciprocal;
      for (int j = i + 1; j <= k; ++j) L[k][j] -= factor * L[j][i];
    }
    for (int k = i + 1; k < u; ++k) L[k][i] *= reciprocal;
  }
  Redundancy<T> redundancy;
  for (int k = 0; k < u; ++k) {  // (L^-1)' D^-1 L^-1 on its diagonal
    T column[u], left = T(0);
    for (int i = k; i < u; ++i) {
      column[i] = T(i == k ? 1 : 0);
      for (int j = k; j < i; ++j) column[i] -= L[i][j] * column[j];
      left += column[i] * column[i] * L[i][i];
    }
    redundancy.add(held[k] * left);
  }
  redundancy.tell(u, status);
  for (int step = 0; step < Proximal<T>::steps; ++step) {
    for (int i = 0; i < u; ++i) y[i] = to[i] + held[i] * y[i];
    for (int i = 0; i < u; ++i)
      for (int j = 0; j < i; ++j) y[i] -= L[i][j] * y[j];
    for (int i = u - 1; i >= 0; --i) {
      y[i] *= L[i][i];
      for (int k = i + 1; k < u; ++k) y[i] -= L[k][i] * y[k];
    }
  }
}

// The largest error of those at f(0), f(1), …; NaN once one is no number.
template <int count, class T, class F>
static DALEMBERT_INLINE T largest_error(const F& f) {
  T most = T(0), undefined = T(0);
  for (int i = 0; i < count; ++i) {
    const T size = std::fabs(f(i));
    most = size > most ? size : most;
    undefined += size - size;
  }
  return most + undefined;
}

// Of J_u' W J_u, the half below the diagonal.
template <int all, int u, class T>
static DALEMBERT_INLINE void products_of_rows(const T (&jacobian)[u][all], const T* weight, T (&to)[u][u]) {
  if constexpr (u <= 8) {
    constexpr int w = least(native_lanes, 4), pieces = (u + w - 1) / w;
    using Row = BlockRow<T, w, pieces>;
    Row sums[u] = {};
    DALEMBERT_KEEP_LOOP
    for (int r = 0; r < all; ++r) {
      const Row row = Row::of([&](int i) { return i < u ? jacobian[least(i, u - 1)][r] : T(0); });
      const Lanes<T, w> times = broadcast<w, T>(weight[r]);
      Row weighted;
      for_constants<pieces>([&](auto k) DALEMBERT_IN_BLOCK { weighted.piece[k] = times * row.piece[k]; });
      for_constants<u>([&](auto i) DALEMBERT_IN_BLOCK {
        const Lanes<T, w> factor = broadcast<w, T>(jacobian[i][r]);
        for_constants<pieces>([&](auto k) DALEMBERT_IN_BLOCK { sums[i].piece[k] += factor * weighted.piece[k]; });
      });
    }
    constexpr int padded = w * pieces;
    alignas(64) T own[u * padded];
    for_constants<u>([&](auto i) DALEMBERT_IN_BLOCK { sums[i].store(own + i * padded); });
    for_constants<u>([&](auto i) DALEMBERT_IN_BLOCK {
      for (int j = 0; j <= i; ++j) to[i][j] = own[i * padded + j];
    });
  } else {
    for (int i = 0; i < u; ++i)
      for (int j = 0; j <= i; ++j) {
        T sum = T(0);
        for (int r = 0; r < all; ++r) sum += jacobian[i][r] * weight[r] * jacobian[j][r];
        to[i][j] = sum;
      }
  }
}

// Forces f = W J_u y, and how y was found.
template <class Rows, class Without, class T>
static DALEMBERT_INLINE ConstraintStatus<T> support_forces(const T* jacobian, const T* active, const T* weights, const T* to,
                                                           T* forces) {
  constexpr int all = Rows::first(Rows::count), u = Without::count;
  ConstraintStatus<T> status;
  if constexpr (u == 0) {
    for (int r = 0; r < all; ++r) forces[r] = T(0);
    return status;
  } else {
    const Weights<Rows, T> used(active, weights);
    T weight[all];
    each_index<Rows::count>([&](auto c) DALEMBERT_IN_BLOCK {
      for (int r = Rows::first(c); r < Rows::first(c + 1); ++r) weight[r] = active[c] > T(0) ? used.of[r] : T(0);
    });
    T rows[u][all], A[u][u], held[u], lacking[u], y[u];
    for (int i = 0; i < u; ++i) {
      lacking[i] = to[Without::at[i]];
      each_piece<all>([&](auto lanes, auto at) DALEMBERT_IN_BLOCK {
        constexpr int w = decltype(lanes)::value, from = decltype(at)::value;
        store<w, T>(rows[i] + from, without_rounding<T>(load<w>(jacobian + Without::at[i] * all + from)));
      });
    }
    products_of_rows(rows, weight, A);
    hold<u, Without::base>([&](int i) { return A[i][i]; }, held);
    if constexpr (u <= 8) solve_support(A, held, lacking, y, status);
    else solve_support_in_loops(A, held, lacking, y, status);
    each_piece<all>([&](auto lanes, auto at) DALEMBERT_IN_BLOCK {
      constexpr int w = decltype(lanes)::value, from = decltype(at)::value;
      Lanes<T, w> sum{};
      for (int i = 0; i < u; ++i) sum += broadcast<w, T>(y[i]) * load<w>(rows[i] + from);
      store<w, T>(forces + from, sum * load<w>(weight + from));
    });
    if (!used.are_weights) status.least_pivot = T(-1);
    return status;
  }
}

// Of a wrench on the base, along its axes about its origin, that constraint c bears: what is left to do.
template <class Rows, class C, class Axes, class T>
static DALEMBERT_INLINE void bear(C c, const Axes& axes, const T (&wrench)[6], T* to) {
  for_constants<6>([&](auto j) DALEMBERT_IN_BLOCK { to[j] -= wrench[j]; });
  each_above<Rows>(c, [&](auto k) DALEMBERT_IN_BLOCK {
    if (k < 6) return;
    const int at = Rows::paths[c][k];
    const auto joint = axes.joint(Rows::moving.of[c][k] - 6, at);
    const auto along = [&](int j) DALEMBERT_IN_BLOCK { return joint.axis(j) * wrench[j]; };
    const T first = along(0) + along(1), second = along(2) + along(3), third = along(4) + along(5);
    to[at] -= first + second + third;
  });
}

// Rows along the world's axes at points, one constraint after another. turn: the base's axes in the world, column by column.
template <class Rows, class Axes, class T, int = native_lanes>
struct RowsAtPoints {
  static constexpr int base = 6;
  const Axes& axes;
  T points[Rows::count][3], weight[Rows::count][base];

  DALEMBERT_INLINE RowsAtPoints(const Axes& of, const T* where, const T* active, const T* weights) : axes(of) {
    each_index<Rows::count>([&](auto c) DALEMBERT_IN_BLOCK {
      for_constants<3>([&](auto i) DALEMBERT_IN_BLOCK { points[c][i] = without_rounding<T>(where[3 * c + i]); });
      for_constants<base>([&](auto r) DALEMBERT_IN_BLOCK {
        if (r < Rows::rows[c]) weight[c][r] = active[c] > T(0) ? weights[Rows::first(c) + r] : T(0);
      });
    });
  }

  // A is the sum over the rows e of points x of w [e; x × e] [e; x × e]'.
  DALEMBERT_INLINE void products(T (&A)[base][base]) const {
    for_constants<base>([&](auto i)
                            DALEMBERT_IN_BLOCK { for_constants<base>([&](auto j) DALEMBERT_IN_BLOCK { A[i][j] = T(0); }); });
    each_index<Rows::count>([&](auto c) DALEMBERT_IN_BLOCK {
      const T* const own = weight[c];
      const T x = points[c][0], y = points[c][1], z = points[c][2];
      const T xy = own[1] * x, xz = own[2] * x, yx = own[0] * y, yz = own[2] * y, zx = own[0] * z, zy = own[1] * z;
      A[0][0] += own[0], A[1][1] += own[1], A[2][2] += own[2];
      A[4][0] += zx, A[5][0] -= yx, A[3][1] -= zy, A[5][1] += xy, A[3][2] += yz, A[4][2] -= xz;
      A[3][3] += zy * z + yz * y, A[4][4] += zx * z + xz * x, A[5][5] += yx * y + xy * x;
      A[4][3] -= yz * x, A[5][3] -= zy * x, A[5][4] -= yx * z;
      if (Rows::rows[c] > 3) A[3][3] += own[3], A[4][4] += own[4], A[5][5] += own[5];
    });
  }

  // Forces of y, and what they leave to do.
  DALEMBERT_INLINE void bear(const T* turn, const T (&y)[base], T* forces, T* to) const {
    each_index<Rows::count>([&](auto c) DALEMBERT_IN_BLOCK {
      const T *const at = points[c], *const own = weight[c];
      T *const force = forces + Rows::first(c), moment[3];
      for_constants<3>([&](auto i) DALEMBERT_IN_BLOCK {
        constexpr int next = (decltype(i)::value + 1) % 3, last = (decltype(i)::value + 2) % 3;
        force[i] = own[i] * (y[i] + (y[3 + next] * at[last] - y[3 + last] * at[next]));
      });
      for_constants<3>([&](auto i) DALEMBERT_IN_BLOCK {
        constexpr int next = (decltype(i)::value + 1) % 3, last = (decltype(i)::value + 2) % 3;
        moment[i] = at[next] * force[last] - at[last] * force[next];
        if (Rows::rows[c] > 3) moment[i] += force[3 + i] = own[3 + i] * y[3 + i];
      });
      T pushed[base];
      for_constants<base>([&](auto j) DALEMBERT_IN_BLOCK {
        constexpr int column = 3 * (decltype(j)::value % 3);
        const T* const by = decltype(j)::value < 3 ? force : moment;
        pushed[j] = turn[column] * by[0] + turn[column + 1] * by[1] + turn[column + 2] * by[2];
      });
      constraint_detail::bear<Rows>(c, axes, pushed, to);
    });
  }
};

// The same of limbs beside each other, all constraints at once.
template <class Rows, class Axes, class T, int = native_lanes>
struct RowsAtPointsBeside {
  using Beside = ConstraintsBeside<Rows, Axes, T>;
  using V = typename Beside::V;
  using One = BlockRow<T, Beside::lanes, 1>;
  static constexpr int base = 6, rows = Rows::rows[0], lanes = Beside::lanes;
  const Axes& axes;
  V at[3], weight[rows];

  DALEMBERT_INLINE RowsAtPointsBeside(const Axes& of, const T* points, const T* active, const T* weights) : axes(of) {
    Beside::load_points(points, at);
    for_constants<3>([&](auto i) DALEMBERT_IN_BLOCK { at[i] = without_rounding<T>(at[i]); });
    const V acts = Beside::of_constraints([&](int c) { return active[c]; });
    for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
      const V own = Beside::of_constraints([&](int c) { return weights[rows * c + r]; });
      weight[r] = acts > V{} ? own : V{};
    });
  }

  DALEMBERT_INLINE void products(T (&A)[base][base]) const {
    const V x = at[0], y = at[1], z = at[2];
    const V xy = weight[1] * x, xz = weight[2] * x, yx = weight[0] * y, yz = weight[2] * y, zx = weight[0] * z,
            zy = weight[1] * z;
    One of[16] = {{{weight[0]}}, {{weight[1]}}, {{weight[2]}}, {{zx}}, {{yx}}, {{zy}}, {{xy}}, {{yz}}, {{xz}}};
    of[9].piece[0] = zy * z + yz * y, of[10].piece[0] = zx * z + xz * x, of[11].piece[0] = yx * y + xy * x;
    of[12].piece[0] = yz * x, of[13].piece[0] = zy * x, of[14].piece[0] = yx * z;
    if constexpr (rows > 3) for_constants<3>([&](auto i) DALEMBERT_IN_BLOCK { of[9 + i].piece[0] += weight[3 + i]; });
    T sums[16];
    Beside::over_limbs(of, sums);
    for_constants<3>([&](auto i) DALEMBERT_IN_BLOCK { A[i][i] = sums[i], A[3 + i][3 + i] = sums[9 + i]; });
    A[1][0] = A[2][0] = A[2][1] = A[3][0] = A[4][1] = A[5][2] = T(0);
    A[4][0] = sums[3], A[5][0] = -sums[4], A[3][1] = -sums[5], A[5][1] = sums[6], A[3][2] = sums[7], A[4][2] = -sums[8];
    A[4][3] = -sums[12], A[5][3] = -sums[13], A[5][4] = -sums[14];
  }

  DALEMBERT_INLINE void bear(const T* turn, const T (&y)[base], T* forces, T* to) const {
    V force[rows], moment[3], pushed[base];
    const auto all = [](T x) DALEMBERT_IN_BLOCK { return broadcast<lanes, T>(x); };
    for_constants<3>([&](auto i) DALEMBERT_IN_BLOCK {
      constexpr int next = (decltype(i)::value + 1) % 3, last = (decltype(i)::value + 2) % 3;
      force[i] = weight[i] * (all(y[i]) + (all(y[3 + next]) * at[last] - all(y[3 + last]) * at[next]));
    });
    for_constants<3>([&](auto i) DALEMBERT_IN_BLOCK {
      constexpr int next = (decltype(i)::value + 1) % 3, last = (decltype(i)::value + 2) % 3;
      moment[i] = at[next] * force[last] - at[last] * force[next];
      if constexpr (rows > 3) moment[i] += force[3 + i] = weight[3 + i] * all(y[3 + i]);
    });
    One of[8] = {};
    for_constants<base>([&](auto j) DALEMBERT_IN_BLOCK {
      constexpr int column = 3 * (decltype(j)::value % 3);
      const V* const by = decltype(j)::value < 3 ? force : moment;
      of[j].piece[0] = pushed[j] = all(turn[column]) * by[0] + all(turn[column + 1]) * by[1] + all(turn[column + 2]) * by[2];
    });
    T sums[8];
    Beside::over_limbs(of, sums);
    for_constants<base>([&](auto j) DALEMBERT_IN_BLOCK { to[j] -= sums[j]; });
    for_constants<Beside::steps>([&](auto step) DALEMBERT_IN_BLOCK {
      const auto joints = axes.template beside<lanes>(Beside::slot(step));
      const auto along = [&](int j) DALEMBERT_IN_BLOCK { return joints.axis(j) * pushed[j]; };
      const V first = along(0) + along(1), second = along(2) + along(3), third = along(4) + along(5),
              done = first + second + third;
      for_constants<lanes>([&](auto l) DALEMBERT_IN_BLOCK {
        constexpr int limb = decltype(l)::value, k = decltype(step)::value;
        if constexpr (Beside::has_joint(limb, k)) to[Beside::coordinate(limb, k)] -= lane<lanes, T>(done, l);
      });
    });
    if constexpr (rows == 3) {
      Beside::store_points(force, forces);
    } else {
      for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
        for_constants<lanes>([&](auto l) DALEMBERT_IN_BLOCK {
          constexpr int c = Beside::in.limb[decltype(l)::value];
          if constexpr (c >= 0) forces[rows * c + r] = lane<lanes, T>(force[r], l);
        });
      });
    }
  }
};

}  // namespace constraint_detail

// to becomes to - J' f, f = W J_u y being what makes it zero at the coordinates u that have no motor: of all such f the one
// with the least sum of f^2 / W. y is found by proximal steps as above, with N as hold() has it: what no constraint can bear
// stays, and is the residual. The least pivot is -1 where a row that acts has a weight that is none.
template <int n, class Rows, class Without, class T>
__attribute__((noinline)) static ConstraintStatus<T> support(const T* jacobian, const T* active, const T* weights, T* forces,
                                                             T* to) noexcept {
  constexpr int all = Rows::first(Rows::count), u = Without::count;
  ConstraintStatus<T> status = constraint_detail::support_forces<Rows, Without>(jacobian, active, weights, to, forces);
  T borne[n] = {};
  constraint_detail::each_index<Rows::count>([&](auto c) DALEMBERT_IN_BLOCK {
    constraint_detail::each_above<Rows>(c, [&](auto k) DALEMBERT_IN_BLOCK {
      const int at = Rows::paths[c][k];
      for (int r = Rows::first(c); r < Rows::first(c + 1); ++r) borne[at] += jacobian[at * all + r] * forces[r];
    });
  });
  for (int k = 0; k < n; ++k) to[k] -= borne[k];
  if constexpr (u > 0) status.residual = constraint_detail::largest_error<u, T>([&](int i) { return to[Without::at[i]]; });
  return status;
}

// The same where the base floats and is all that has no motor. wrenches: J's columns of the base, what rows push it with, which
// is all that is needed: joints feel it along their axes.
template <int n, class Rows, class Axes, class T>
__attribute__((noinline)) static ConstraintStatus<T> support_by_wrenches(const Axes& axes, const T* wrenches, const T* active,
                                                                         const T* weights, T* forces, T* to) noexcept {
  constexpr int all = Rows::first(Rows::count), base = 6;
  ConstraintStatus<T> status =
      constraint_detail::support_forces<Rows, Undriven<base, 0, 1, 2, 3, 4, 5>>(wrenches, active, weights, to, forces);
  constraint_detail::each_index<Rows::count>([&](auto c) DALEMBERT_IN_BLOCK {
    T pushed[base];
    constraint_detail::for_constants<base>([&](auto j) DALEMBERT_IN_BLOCK {
      T sums[2] = {};
      for (int r = 0; r < Rows::rows[c]; ++r)
        sums[r % 2] += wrenches[j * all + Rows::first(c) + r] * forces[Rows::first(c) + r];
      pushed[j] = sums[0] + sums[1];
    });
    constraint_detail::bear<Rows>(c, axes, pushed, to);
  });
  status.residual = constraint_detail::largest_error<base, T>([&](int j) { return to[j]; });
  return status;
}

// The same where all rows are along the world's axes: seen along these, what rows push the base with is ones, and where they
// push it. turn: the base's axes in the world, column by column. points: where constraints act, from the base's origin along
// the world's axes, three numbers each. In place of a call: points and weights have just been
// computed, and need not go through memory.
template <int n, class Rows, class Axes, class T>
static DALEMBERT_INLINE ConstraintStatus<T> support_at_points(const Axes& axes, const T* turn, const T* points, const T* active,
                                                              const T* weights, T* forces, T* to) noexcept {
  using namespace constraint_detail;
  constexpr int base = 6;
  using Support = std::conditional_t<(limbs_beside<Rows, Axes>().slot >= 0), RowsAtPointsBeside<Rows, Axes, T>,
                                     RowsAtPoints<Rows, Axes, T>>;
  ConstraintStatus<T> status;
  const Weights<Rows, T> used(active, weights);
  const Support rows(axes, points, active, used.of);
  T A[base][base], held[base], lacking[base], y[base];
  rows.products(A);
  hold<base, base>([&](int i) { return A[i][i]; }, held);
  for_constants<base>([&](auto i) DALEMBERT_IN_BLOCK {
    constexpr int from = decltype(i)::value / 3 * 3, row = decltype(i)::value % 3;
    lacking[i] = turn[row] * to[from] + turn[3 + row] * to[from + 1] + turn[6 + row] * to[from + 2];
  });
  solve_support_of_base(A, held, lacking, y, status);
  if (!used.are_weights) status.least_pivot = T(-1);
  rows.bear(turn, y, forces, to);
  status.residual = largest_error<base, T>([&](int j) { return to[j]; });
  return status;
}

}  // namespace dalembert
