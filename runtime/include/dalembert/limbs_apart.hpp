// Points of limbs that have the base in common and nothing else, as the feet of animals with many legs: one limb in each lane.
//
// What a limb's joints leave is a small matrix of its own, S, and limbs know of each other by the base alone, W being Y's rows
// there and D_b the base's pivots (constraints.hpp):
//
//   (S + W' D_b^-1 W) f = c   is   f = S^-1 c - X' D^-1 X c,   L D L' = D_b + W S^-1 W',   X = L^-1 W S^-1.
//
// So a matrix of six is factored whatever the number of limbs, and for all limbs at once one of three inverted. mu N is part of
// S; where a limb's rows say what others of it say, X has numbers of 1/mu that cancel, and half of the digits are left: the
// last proximal step adds what is missing, as there.
#pragma once

#include <dalembert/constraints_beside.hpp>

namespace dalembert {
namespace constraint_detail {

// Whether constraints are points of limbs beside each other: at least three, for two are solved for together as fast, and none
// with fewer joints than rows, whose S would be singular everywhere.
template <class Rows, class Limbs>
constexpr bool are_points_of_limbs_apart() {
  for (const int length : Rows::lengths)
    if (length < 9) return false;
  return Rows::count >= 3 && Rows::rows[0] == 3 && limbs_beside<Rows, Limbs>().slot >= 0;
}

template <class Rows, class Limbs, class T, int = native_lanes>
struct LimbsApart {
  using Beside = ConstraintsBeside<Rows, Limbs, T>;
  static constexpr int base = Beside::base, rows = 3, steps = Beside::steps, lanes = Beside::lanes;
  using V = typename Beside::V;
  using One = BlockRow<T, lanes, 1>;

  const Limbs& limbs;
  V own[steps][rows], own_reciprocal[steps];  // Y of limbs' joints, and D^-1
  V at_base[base][rows];                      // W
  T base_pivot[base], base_reciprocal[base];
  V along[rows][rows], inverse[rows][rows];  // S without R and mu N, the lower half; S^-1
  V response[base][rows];                    // L^-1 W S^-1, L D L' = D_b + W S^-1 W'
  T reciprocal[base];                        // D^-1

  explicit DALEMBERT_INLINE LimbsApart(const Limbs& of) : limbs(of) {}

  static constexpr int larger(int a, int b) { return a > b ? a : b; }
  static DALEMBERT_INLINE V product(const V (&a)[rows], const V (&b)[rows]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

  // Y, S and what the base's own pivots are.
  DALEMBERT_INLINE void fill(const T* wrenches, const V& acts) {
    constexpr int all = Rows::first(Rows::count);
    for_constants<base>([&](auto j) DALEMBERT_IN_BLOCK {
      Beside::load_points(wrenches + j * all, at_base[j]);
      for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK { at_base[j][r] = without_rounding<T>(at_base[j][r]) * acts; });
    });
    for_constants<base>([&](auto j) DALEMBERT_IN_BLOCK {
      base_pivot[j] = limbs.pivot(j);
      base_reciprocal[j] = T(1) / base_pivot[j];
    });
    for_constants<steps>([&](auto back) DALEMBERT_IN_BLOCK {
      constexpr std::integral_constant<int, steps - 1 - decltype(back)::value> step{};
      constexpr int slot = Beside::slot(decltype(step)::value);
      const auto joints = limbs.template beside<lanes>(slot);
      const auto axis = [&](int j) DALEMBERT_IN_BLOCK { return Beside::of_joints(step, joints.axis(j)); };
      for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
        const auto of = [&](int j) DALEMBERT_IN_BLOCK { return axis(j) * at_base[j][r]; };
        const V first = of(0) + of(1), second = of(2) + of(3), third = of(4) + of(5);
        own[step][r] = first + second + third;
      });
      for_constants<base>([&](auto j) DALEMBERT_IN_BLOCK {
        const V yields = Beside::of_joints(step, joints.gain(j));
        for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK { at_base[j][r] -= yields * own[step][r]; });
      });
      own_reciprocal[step] = Beside::of_joints(step, broadcast<lanes, T>(T(1)) / load<lanes>(limbs.pivot_slots + slot));
    });
    for_constants<base>([&](auto back) DALEMBERT_IN_BLOCK {
      constexpr int k = base - 1 - decltype(back)::value;
      for_constants<k>([&](auto j) DALEMBERT_IN_BLOCK {
        const V yields = broadcast<lanes, T>(limbs.base_gain(k, j));
        for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK { at_base[j][r] -= yields * at_base[k][r]; });
      });
    });
    for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
      for_constants<decltype(r)::value + 1>([&](auto s) DALEMBERT_IN_BLOCK { along[r][s] = V{}; });
      for_constants<steps>([&](auto k) DALEMBERT_IN_BLOCK {
        const V weighted = own[k][r] * own_reciprocal[k];
        for_constants<decltype(r)::value + 1>([&](auto s) DALEMBERT_IN_BLOCK { along[r][s] += weighted * own[k][s]; });
      });
    });
  }

  // J M^-1 J'.
  DALEMBERT_INLINE void delassus(T* to) const {
    constexpr int all = Rows::first(Rows::count);
    alignas(64) T weighted[base][rows][lanes];  // D_b^-1 W
    for_constants<base>([&](auto j) DALEMBERT_IN_BLOCK {
      for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
        store<lanes, T>(weighted[j][r], broadcast<lanes, T>(base_reciprocal[j]) * at_base[j][r]);
      });
    });
    for_constants<lanes>([&](auto limb) DALEMBERT_IN_BLOCK {
      constexpr int l = decltype(limb)::value, c = Beside::in.limb[l];
      if constexpr (c >= 0) {
        for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
          V row[rows];
          for_constants<rows>([&](auto s) DALEMBERT_IN_BLOCK {
            row[s] = with_lane_of<lanes, T, l>(V{}, along[larger(r, s)][least(r, s)]);
            for_constants<base>([&](auto j)
                                    DALEMBERT_IN_BLOCK { row[s] += broadcast<lanes, T>(weighted[j][r][l]) * at_base[j][s]; });
          });
          Beside::store_points(row, to + (rows * c + r) * all);
        });
      }
    });
    for (int i = 1; i < all; ++i)  // the same numbers below the diagonal and above it
      for (int k = 0; k < i; ++k) to[i * all + k] = to[k * all + i];
  }

  // What rows move of themselves, per limb and row.
  DALEMBERT_INLINE V diagonal(int r) const {
    V of = along[r][r];
    for_constants<base>(
        [&](auto j) DALEMBERT_IN_BLOCK { of += at_base[j][r] * at_base[j][r] * broadcast<lanes, T>(base_reciprocal[j]); });
    return of;
  }

  // more: what the diagonal has more.
  DALEMBERT_INLINE void invert(const V (&more)[rows]) {
    V limb[rows][rows];
    for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
      for_constants<decltype(r)::value + 1>([&](auto s) DALEMBERT_IN_BLOCK { limb[r][s] = along[r][s]; });
      limb[r][r] += more[r];
    });
    invert_few(limb, inverse);
    for_constants<base>([&](auto j) DALEMBERT_IN_BLOCK {
      for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK { response[j][r] = product(inverse[r], at_base[j]); });
    });
    One of_pairs[24] = {};  // of base x base, the lower half
    for_constants<base>([&](auto i) DALEMBERT_IN_BLOCK {
      for_constants<decltype(i)::value + 1>(
          [&](auto j) DALEMBERT_IN_BLOCK { of_pairs[i * (i + 1) / 2 + j].piece[0] = product(response[i], at_base[j]); });
    });
    T a[24];
    Beside::over_limbs(of_pairs, a);
    const auto at = [](int i, int j) { return i * (i + 1) / 2 + j; };
    for_constants<base>([&](auto i) DALEMBERT_IN_BLOCK { a[at(i, i)] += base_pivot[i]; });
    for_constants<base>([&](auto j) DALEMBERT_IN_BLOCK {
      reciprocal[j] = T(1) / a[at(j, j)];
      for_constants<base - 1 - j>([&](auto behind) DALEMBERT_IN_BLOCK {
        constexpr int i = decltype(j)::value + 1 + decltype(behind)::value;
        const T factor = a[at(i, j)] * reciprocal[j];
        for_constants<i - j>([&](auto k) DALEMBERT_IN_BLOCK { a[at(i, j + 1 + k)] -= factor * a[at(j + 1 + k, j)]; });
        for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK { response[i][r] -= broadcast<lanes, T>(factor) * response[j][r]; });
      });
    });
  }

  // The diagonal of the inverse of all rows.
  DALEMBERT_INLINE V left_of(int r) const {
    V left = inverse[r][r];
    for_constants<base>(
        [&](auto j) DALEMBERT_IN_BLOCK { left -= response[j][r] * response[j][r] * broadcast<lanes, T>(reciprocal[j]); });
    return left;
  }

  DALEMBERT_INLINE void solve(const V (&right)[rows], V (&f)[rows]) const {
    One of[8] = {};
    T z[8];
    for_constants<base>([&](auto j) DALEMBERT_IN_BLOCK { of[j].piece[0] = product(response[j], right); });
    Beside::over_limbs(of, z);
    for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
      V sum[2] = {inverse[r][0] * right[0] + inverse[r][1] * right[1], inverse[r][2] * right[2]};
      for_constants<base>([&](auto j)
                              DALEMBERT_IN_BLOCK { sum[j % 2] -= response[j][r] * broadcast<lanes, T>(z[j] * reciprocal[j]); });
      f[r] = sum[0] + sum[1];
    });
  }

  // D_b^-1 W f.
  DALEMBERT_INLINE void moved_base(const V (&f)[rows], T (&to)[8]) const {
    One of[8] = {};
    for_constants<base>([&](auto j) DALEMBERT_IN_BLOCK { of[j].piece[0] = product(at_base[j], f); });
    Beside::over_limbs(of, to);
    for_constants<base>([&](auto j) DALEMBERT_IN_BLOCK { to[j] *= base_reciprocal[j]; });
  }

  // rest = rest - (S + W' D_b^-1 W) f.
  DALEMBERT_INLINE void subtract_along(const V (&f)[rows], V (&rest)[rows]) const {
    T moves[8];
    moved_base(f, moves);
    V sum[rows];
    for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
      sum[r] = V{};
      for_constants<rows>([&](auto s) DALEMBERT_IN_BLOCK { sum[r] += along[larger(r, s)][least(r, s)] * f[s]; });
    });
    for_constants<base>([&](auto j) DALEMBERT_IN_BLOCK {
      for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
        if constexpr (decltype(j)::value % 2 == 0) rest[r] -= broadcast<lanes, T>(moves[j]) * at_base[j][r];
        else sum[r] += broadcast<lanes, T>(moves[j]) * at_base[j][r];
      });
    });
    for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK { rest[r] -= sum[r]; });
  }
};

// As solve() of constraints.hpp, by articulated bodies. x comes as D^-1 L'^-1 of the efforts; at_rest: whether it is zero.
template <int n, class Rows, class Tree, bool at_rest, class Limbs, class T>
static DALEMBERT_INLINE ConstraintStatus<T> solve_limbs_apart(const Limbs& limbs, const T* wrenches, const T* right,
                                                              const T* active, const T* regularization, T* forces, T* x) {
  using Apart = LimbsApart<Rows, Limbs, T>;
  using Beside = typename Apart::Beside;
  using V = typename Apart::V;
  constexpr int lanes = Apart::lanes, rows = Apart::rows, base = Apart::base, steps = Apart::steps;
  const V none{}, one = broadcast<lanes, T>(T(1));
  const V given = Beside::of_constraints([&](int c) { return active[c]; });
  Apart apart(limbs);
  apart.fill(wrenches, given);

  // c, mu N, and what the diagonal has more.
  V known[rows], held[rows], regular[rows], more[rows], all_along[rows], at_joints[steps];
  V of_limb = none, negative = none;
  for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
    all_along[r] = apart.diagonal(r);
    of_limb += all_along[r];
  });
  const V sum = broadcast<lanes, T>(T(least_share) * BlockRow<T, lanes, 1>{{of_limb}}.total()) + of_limb * T(1.0 / 3);
  const V mean = sum > none ? sum : one;
  Beside::load_points(regularization, regular);
  Beside::load_points(right, known);
  for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
    const V hold = (all_along[r] > none ? broadcast<lanes, T>(Proximal<T>::mu) : one) * mean;
    held[r] = given > none ? hold : none;
    regular[r] = given > none ? regular[r] : none;
    negative += regular[r] < none ? one : none;
    more[r] = given > none ? hold + regular[r] : one;
    known[r] = given > none ? known[r] : none;
  });
  if constexpr (!at_rest) {
    V others[rows] = {};
    for_constants<steps>([&](auto k) DALEMBERT_IN_BLOCK {
      constexpr int step = decltype(k)::value;
      at_joints[k] =
          each_lane<lanes, T>([&](int l) { return Beside::has_joint(l, step) ? x[Beside::coordinate(l, step)] : T(0); });
      for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK { others[r] += at_joints[k] * apart.own[k][r]; });
    });
    for_constants<base>([&](auto j) DALEMBERT_IN_BLOCK {
      for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK { known[r] -= broadcast<lanes, T>(x[j]) * apart.at_base[j][r]; });
    });
    for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK { known[r] -= others[r]; });
  }
  apart.invert(more);

  ConstraintStatus<T> status;
  int acting = 0;
  for (int c = 0; c < Rows::count; ++c) acting += active[c] > T(0) ? rows : 0;
  RedundancyInLanes<T, lanes> redundancy;
  for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK { redundancy.add(held[r] * apart.left_of(r)); });
  redundancy.of_all().tell(acting, status);
  if (BlockRow<T, lanes, 1>{{negative}}.total() > T(0)) status.least_pivot = T(-1);

  // Products with an inverse leave an error of its condition: the last step adds what is missing.
  V before[rows], rest[rows], solved[rows];
  apart.solve(known, before);
  for_constants<Proximal<T>::steps - 2>([&](auto) DALEMBERT_IN_BLOCK {
    for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK { rest[r] = known[r] + held[r] * before[r]; });
    apart.solve(rest, before);
  });
  for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK { rest[r] = known[r] - regular[r] * before[r]; });
  apart.subtract_along(before, rest);
  apart.solve(rest, solved);
  ErrorInLanes<T, lanes> error;
  for_constants<rows>([&](auto r) DALEMBERT_IN_BLOCK {
    error.add(held[r] * solved[r]);
    solved[r] += before[r];
  });
  Beside::store_points(solved, forces);
  status.residual = error.of_all();

  T moves[8];
  apart.moved_base(solved, moves);
  for_constants<base>([&](auto j) DALEMBERT_IN_BLOCK { x[j] += moves[j]; });
  for_constants<steps>([&](auto k) DALEMBERT_IN_BLOCK {
    constexpr int step = decltype(k)::value;
    V moved = Apart::product(apart.own[k], solved) * apart.own_reciprocal[k];
    if constexpr (!at_rest) moved += at_joints[k];
    for_constants<lanes>([&](auto l) DALEMBERT_IN_BLOCK {
      constexpr int limb = decltype(l)::value;
      if constexpr (Beside::has_joint(limb, step)) x[Beside::coordinate(limb, step)] = lane<lanes, T>(moved, l);
    });
  });
  accelerate_outwards<Tree>(limbs, x);
  return status;
}

}  // namespace constraint_detail
}  // namespace dalembert
