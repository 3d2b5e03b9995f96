// What contacts and loops bear in inverse dynamics: forces that leave nothing to do for coordinates without a motor, the least
// of all such by their weights. Nothing allocates; loops depend on the robot and its constraints alone.
#pragma once

#include <dalembert/constraint_blocks.hpp>
#include <dalembert/constraint_limbs.hpp>
#include <dalembert/constraint_shapes.hpp>

namespace dalembert {

// Joints' axes for what constraints bear: of the coordinates above them but for the base's, in the order in which constraints
// name them, six numbers each.
template <class T>
struct AxesInArray {
  const T* axes;
  typename LimbsInArrays<T>::Joint joint(int place, int) const { return {nullptr, axes + 6 * place}; }
};

// Coordinates without a motor.
template <int... coordinates>
struct Undriven {
  static constexpr int count = sizeof...(coordinates);
  static constexpr int at[sizeof...(coordinates) + 1] = {coordinates..., 0};
};

namespace constraint_detail {

// y of support(): (J_u' W J_u + mu N) y = to_u + mu N y, a few times over.
template <int all, class Without, class T>
DALEMBERT_INLINE void solve_support(const T* jacobian, const T* weighted, const T* to, T* y, ConstraintStatus<T>& status) {
  constexpr int u = Without::count;
  Redundancy<T> redundancy;
  if constexpr (u > 0 && u <= 8) {  // a floating base
    constexpr int w = native_lanes, pieces = (u + w - 1) / w;
    RowsInRegisters<u, pieces, SameColumns, T> a;
    using Row = BlockRow<T, w, pieces>;
    for_constants<u>([&](auto i) DALEMBERT_IN_BLOCK { a.rows[i] = Row{}; });
    DALEMBERT_KEEP_LOOP
    for (int r = 0; r < all; ++r) {
      const Row row = Row::of([&](int i) { return i < u ? jacobian[Without::at[least(i, u - 1)] * all + r] : T(0); });
      for_constants<u>([&](auto i) DALEMBERT_IN_BLOCK {
        const Lanes<T, w> factor = broadcast<w, T>(weighted[i * all + r]);
        for_constants<pieces>([&](auto k) DALEMBERT_IN_BLOCK { a.rows[i].piece[k] += factor * row.piece[k]; });
      });
    }
    T held[u], left_of[u];
    for_constants<u>([&](auto i) DALEMBERT_IN_BLOCK {
      const T own = lane<w, T>(a.rows[i].piece[i / w], i % w);
      held[i] = Proximal<T>::mu * (own > T(0) ? own : T(1));
    });
    const auto of = [](const T* from)
                        DALEMBERT_IN_BLOCK { return Row::of([&](int i) { return i < u ? from[least(i, u - 1)] : T(0); }); };
    const Row hold = of(held);
    for_constants<u>([&](auto i) DALEMBERT_IN_BLOCK { a.rows[i] = a.rows[i].with_only(hold, i); });
    a.invert();
    for_constants<u>([&](auto i) DALEMBERT_IN_BLOCK { left_of[i] = lane<w, T>(a.rows[i].piece[i / w], i % w); });
    for (int i = 0; i < u; ++i) redundancy.add(held[i] * left_of[i]);
    const Row right = Row::of([&](int i) { return i < u ? to[Without::at[least(i, u - 1)]] : T(0); });
    Row solved = a.times(right);
    for_constants<Proximal<T>::steps - 1>([&](auto) DALEMBERT_IN_BLOCK { solved = a.times(right.plus(hold, solved)); });
    for_constants<u>([&](auto i) DALEMBERT_IN_BLOCK { y[i] = lane<w, T>(solved.piece[i / w], i % w); });
  } else {
    // L D L', D's reciprocals on the diagonal.
    constexpr int room = u > 0 ? u : 1;
    T L[room * room], held[room];
    for (int i = 0; i < u; ++i) {
      for (int j = 0; j <= i; ++j) {
        T sum = T(0);
        for (int r = 0; r < all; ++r) sum += jacobian[Without::at[i] * all + r] * weighted[j * all + r];
        L[i * room + j] = sum;
      }
      const T own = L[i * room + i];
      held[i] = Proximal<T>::mu * (own > T(0) ? own : T(1));
      L[i * room + i] = own + held[i];
      y[i] = T(0);
    }
    for (int i = 0; i < u; ++i) {
      const T reciprocal = L[i * room + i] = T(1) / L[i * room + i];
      for (int k = i + 1; k < u; ++k) {
        const T factor = L[k * room + i] * reciprocal;
        for (int j = i + 1; j <= k; ++j) L[k * room + j] -= factor * L[j * room + i];
      }
      for (int k = i + 1; k < u; ++k) L[k * room + i] *= reciprocal;
    }
    for (int k = 0; k < u; ++k) {  // (L^-1)' D^-1 L^-1 on its diagonal
      T column[room], left = T(0);
      for (int i = k; i < u; ++i) {
        column[i] = T(i == k ? 1 : 0);
        for (int j = k; j < i; ++j) column[i] -= L[i * room + j] * column[j];
        left += column[i] * column[i] * L[i * room + i];
      }
      redundancy.add(held[k] * left);
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
  }
  redundancy.tell(u, status);
}

// The largest error so far; NaN once one is.
template <class T>
DALEMBERT_INLINE void keep_largest(T& most, T error) {
  const T size = error < T(0) ? -error : error;
  most = size > most || size != size ? size : most;
}

// Forces f = W J_u y, and how y was found.
template <class Rows, class Without, class T>
DALEMBERT_INLINE ConstraintStatus<T> support_forces(const T* jacobian, const T* active, const T* weights, const T* to,
                                                    T* forces) {
  constexpr int all = Rows::first(Rows::count), u = Without::count, room = u > 0 ? u : 1;
  ConstraintStatus<T> status;
  T weight[all];
  each_index<Rows::count>([&](auto c) DALEMBERT_IN_BLOCK {
    for (int r = Rows::first(c); r < Rows::first(c + 1); ++r) weight[r] = active[c] > T(0) ? weights[r] : T(0);
  });
  T weighted[room * all], y[room];
  for (int i = 0; i < u; ++i)
    for (int r = 0; r < all; ++r) weighted[i * all + r] = weight[r] * jacobian[Without::at[i] * all + r];
  solve_support<all, Without>(jacobian, weighted, to, y, status);
  each_piece<all>([&](auto lanes, auto at) DALEMBERT_IN_BLOCK {
    constexpr int w = decltype(lanes)::value, from = decltype(at)::value;
    Lanes<T, w> sum{};
    for (int i = 0; i < u; ++i) sum += broadcast<w, T>(y[i]) * load<w>(weighted + i * all + from);
    store<w, T>(forces + from, sum);
  });
  return status;
}

}  // namespace constraint_detail

// to becomes to - J' f, f = W J_u y being what makes it zero at the coordinates u that have no motor: of all such f the one
// with the least sum of f^2 / W. y is found by proximal steps as above, with N the diagonal of J_u' W J_u: what no constraint
// can bear stays, and is the residual.
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
  for (int i = 0; i < u; ++i) constraint_detail::keep_largest(status.residual, to[Without::at[i]]);
  return status;
}

// The same where the base floats and is all that has no motor. wrenches: J's columns of the base, what rows push it with, which
// is all that is needed: joints feel it along their axes.
template <int n, class Rows, class Axes, class T>
__attribute__((noinline)) static ConstraintStatus<T> support_by_wrenches(const Axes& axes, const T* wrenches, const T* active,
                                                                         const T* weights, T* forces, T* to) noexcept {
  constexpr int all = Rows::first(Rows::count), base = 6;
  ConstraintStatus<T> status =
      constraint_detail::support_forces<Rows, Undriven<0, 1, 2, 3, 4, 5>>(wrenches, active, weights, to, forces);
  constraint_detail::each_index<Rows::count>([&](auto c) DALEMBERT_IN_BLOCK {
    T pushed[base];
    constraint_detail::for_constants<base>([&](auto j) DALEMBERT_IN_BLOCK {
      T sums[2] = {};
      for (int r = 0; r < Rows::rows[c]; ++r)
        sums[r % 2] += wrenches[j * all + Rows::first(c) + r] * forces[Rows::first(c) + r];
      pushed[j] = sums[0] + sums[1];
      to[j] -= pushed[j];
    });
    constraint_detail::each_above<Rows>(c, [&](auto k) DALEMBERT_IN_BLOCK {
      if (k < base) return;
      const int at = Rows::paths[c][k];
      const auto joint = axes.joint(Rows::moving.of[c][k] - base, at);
      const auto along = [&](int j) DALEMBERT_IN_BLOCK { return joint.axis(j) * pushed[j]; };
      const T first = along(0) + along(1), second = along(2) + along(3), third = along(4) + along(5);
      to[at] -= first + second + third;
    });
  });
  for (int j = 0; j < base; ++j) constraint_detail::keep_largest(status.residual, to[j]);
  return status;
}

}  // namespace dalembert
