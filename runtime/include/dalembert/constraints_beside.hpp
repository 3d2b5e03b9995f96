// Constraints of limbs whose joints stand beside each other, a limb in each lane: whether they are such, and their numbers.
#pragma once

#include <dalembert/constraint_blocks.hpp>
#include <dalembert/constraint_limbs.hpp>
#include <dalembert/constraint_shapes.hpp>

namespace dalembert {
namespace constraint_detail {

// Which lane each constraint has, by the slots of the joints above it.
struct LanesOfLimbs {
  int slot = -1, stride = 0;  // of the first lane's first joint, and from joint to joint; -1: there are no such lanes
  int limb[8] = {-1, -1, -1, -1, -1, -1, -1, -1};
};
// Of constraints of one kind whose limbs have the base in common and nothing else, and have their joints beside each other: as
// many as share a register.
template <class Rows, class Limbs>
constexpr LanesOfLimbs limbs_beside() {
  constexpr int base = 6, lanes = lanes_for(Rows::count);
  LanesOfLimbs none, found;
  if constexpr (Limbs::in_slots && Rows::count >= 2 && lanes <= native_lanes) {
    for (int a = 0; a < Rows::count; ++a) {
      if (Rows::rows[a] != Rows::rows[0] || Rows::linear[a] != 3 || Rows::lengths[a] < base + 2) return none;
      for (int b = a + 1; b < Rows::count; ++b) {
        const auto& both = Rows::shared.pieces[Rows::pair(a, b)];
        if (both.count != 1 || both.a[0] != 0 || both.size[0] != base) return none;
      }
    }
    found.slot = Limbs::slot(Rows::paths[0][base]);
    found.stride = Limbs::slot(Rows::paths[0][base + 1]) - found.slot;
    int last = found.slot;
    for (int c = 0; c < Rows::count; ++c) {
      const int first = Limbs::slot(Rows::paths[c][base]);
      for (int k = base; k < Rows::lengths[c]; ++k)
        if (Limbs::slot(Rows::paths[c][k]) != first + (k - base) * found.stride) return none;
      found.slot = least(found.slot, first);
      last = first > last ? first : last;
    }
    if (found.stride < 1 || last - found.slot >= lanes ||
        found.slot + (Rows::longest() - base - 1) * found.stride + lanes > Limbs::slots_in_all)
      return none;
    for (int c = 0; c < Rows::count; ++c) found.limb[Limbs::slot(Rows::paths[c][base]) - found.slot] = c;
  }
  return found;
}

// Such constraints, a number of each in a lane, and of the joints above them.
template <class Rows, class Limbs, class T, int = native_lanes>
struct ConstraintsBeside {
  static constexpr int base = 6, lanes = lanes_for(Rows::count), steps = Rows::longest() - base;
  static constexpr LanesOfLimbs in = limbs_beside<Rows, Limbs>();
  using V = Lanes<T, lanes>;

  // f(c) of each constraint.
  template <class F>
  static DALEMBERT_INLINE V of_constraints(const F& f) {
    return each_lane<lanes, T>([&](int lane) { return in.limb[lane] < 0 ? T(0) : f(in.limb[lane]); });
  }
  static constexpr bool in_order() {
    for (int c = 0; c < 4; ++c)
      if (in.limb[c] != c) return false;
    return shuffles_in_registers && lanes == 4 && Rows::count == 4;
  }
  // Three numbers per constraint, from one constraint behind the other, and back.
  static DALEMBERT_INLINE void load_points(const T* from, V (&to)[3]) {
    if constexpr (in_order()) {
      const V a = load<4>(from), b = load<4>(from + 4), c = load<4>(from + 8);
      const V first = shuffled<T, 0, 5, 2, 3>(shuffled<T, 0, 1, 6, 3>(a, b), c),
              second = shuffled<T, 0, 1, 6, 3>(shuffled<T, 4, 1, 2, 7>(a, b), c),
              third = shuffled<T, 4, 1, 2, 7>(shuffled<T, 0, 5, 2, 3>(a, b), c);
      to[0] = shuffled<T, 0, 3, 2, 1>(first, first);
      to[1] = shuffled<T, 1, 0, 3, 2>(second, second);
      to[2] = shuffled<T, 2, 1, 0, 3>(third, third);
    } else {
      for_constants<3>([&](auto i) DALEMBERT_IN_BLOCK { to[i] = of_constraints([&](int c) { return from[3 * c + i]; }); });
    }
  }
  static DALEMBERT_INLINE void store_points(const V (&from)[3], T* to) {
    if constexpr (in_order()) {
      const V a = shuffled<T, 0, 3, 2, 1>(from[0], from[0]), b = shuffled<T, 1, 0, 3, 2>(from[1], from[1]),
              c = shuffled<T, 2, 1, 0, 3>(from[2], from[2]);
      store<4, T>(to, shuffled<T, 0, 1, 6, 3>(shuffled<T, 0, 5, 2, 3>(a, b), c));
      store<4, T>(to + 4, shuffled<T, 0, 5, 2, 3>(shuffled<T, 0, 1, 6, 3>(b, a), c));
      store<4, T>(to + 8, shuffled<T, 4, 1, 2, 7>(shuffled<T, 0, 1, 6, 3>(a, b), c));
    } else {
      for_constants<3>([&](auto i) DALEMBERT_IN_BLOCK {
        for_constants<lanes>([&](auto l) DALEMBERT_IN_BLOCK {
          constexpr int c = in.limb[decltype(l)::value];
          if constexpr (c >= 0) to[3 * c + i] = lane<lanes, T>(from[i], l);
        });
      });
    }
  }

  // Joints a step further from the base each.
  static constexpr int slot(int step) { return in.slot + step * in.stride; }
  // Whether a limb has a joint so far from the base.
  static constexpr bool has_joint(int lane, int step) {
    return in.limb[lane] >= 0 && base + step < Rows::lengths[in.limb[lane] < 0 ? 0 : in.limb[lane]];
  }
  static constexpr bool all_have_joints(int step) {
    for (int lane = 0; lane < lanes; ++lane)
      if (!has_joint(lane, step)) return false;
    return true;
  }
  static constexpr int coordinate(int lane, int step) { return Rows::paths[in.limb[lane]][base + step]; }
  // What joints at that step have; zero where a limb has none.
  template <class Step>
  static DALEMBERT_INLINE V of_joints(Step, const V& at_slots) {
    if constexpr (all_have_joints(Step::value)) return at_slots;
    else return each_lane<lanes, T>([](int lane) { return T(has_joint(lane, Step::value) ? 1 : 0); }) > V{} ? at_slots : V{};
  }

  // Sums over limbs of some numbers.
  template <int some>
  static DALEMBERT_INLINE void over_limbs(const BlockRow<T, lanes, 1> (&of)[some], T (&to)[some]) {
    if constexpr (lanes == 2 && shuffles_in_registers) {
      for_constants<some / 2>([&](auto two) DALEMBERT_IN_BLOCK {
        constexpr int i = 2 * decltype(two)::value;
        const V a = of[i].piece[0], b = of[i + 1].piece[0], sums = shuffled<T, 0, 2>(a, b) + shuffled<T, 1, 3>(a, b);
        to[i] = sums[0], to[i + 1] = sums[1];
      });
      return;
    }
    for_constants<some / 4>([&](auto four) DALEMBERT_IN_BLOCK {
      constexpr int i = 4 * decltype(four)::value;
      const Lanes<T, 4> sums = sums_of_four(of + i);
      for_constants<4>([&](auto k) DALEMBERT_IN_BLOCK { to[i + k] = sums[decltype(k)::value]; });
    });
  }
};

}  // namespace constraint_detail
}  // namespace dalembert
