// What articulated bodies leave of each coordinate, V, J and D (pivots.hpp), and accelerations by it from the base outwards:
// M = L' D L, L_ki = V_k.J_i.
#pragma once

#include <dalembert/constraint_blocks.hpp>
#include <dalembert/constraint_shapes.hpp>
#include <tuple>

namespace dalembert {

// Where articulated bodies leave V, J and D of every coordinate: in arrays, six numbers of each,
template <class T>
struct LimbsInArrays {
  static constexpr bool in_slots = false;
  const T *gains, *joints, *pivots;

  struct Joint {
    const T *of_gain, *of_axis;
    T gain(int i) const { return of_gain[i]; }
    T axis(int i) const { return of_axis[i]; }
  };
  Joint at(int k) const { return {gains + 6 * k, joints + 6 * k}; }
  T base_gain(int k, int i) const { return gains[6 * k + i]; }
  T pivot(int k) const { return pivots[k]; }
};
// or in arrays those of the base alone, and the joints' where limbs leave them: components `stride` elements apart, of
// coordinates base, base + 1, … at these slots.
template <class T, int base, int stride, int... slots>
struct LimbsInSlots {
  static constexpr bool in_slots = true;
  static constexpr int slots_in_all = stride;
  DALEMBERT_TABLE int slot_of[sizeof...(slots) + 1] = {slots..., 0};  // with a bound, which clang asks for
  static constexpr int slot(int k) { return slot_of[k - base]; }
  const T *pivot_slots, *gain_slots, *linear_slots, *angular_slots, *gains, *pivots;

  // Of joints at neighbouring slots.
  template <int lanes>
  struct Joints {
    const T *of_gain, *linear, *angular;
    DALEMBERT_INLINE Lanes<T, lanes> gain(int i) const { return load<lanes>(of_gain + i * stride); }
    DALEMBERT_INLINE Lanes<T, lanes> axis(int i) const {
      return load<lanes>(i < 3 ? linear + i * stride : angular + (i - 3) * stride);
    }
  };
  template <int lanes>
  DALEMBERT_INLINE Joints<lanes> beside(int slot) const {
    return {gain_slots + slot, linear_slots + slot, angular_slots + slot};
  }
  DALEMBERT_INLINE Joints<1> at(int k) const { return beside<1>(slot(k)); }
  DALEMBERT_INLINE Joints<1> joint(int, int k) const { return at(k); }
  T base_gain(int k, int i) const { return gains[6 * k + i]; }
  T pivot(int k) const { return k < base ? pivots[k] : pivot_slots[slot(k)]; }
};

namespace constraint_detail {

// Chains of coordinates by articulated bodies: those whose joints stand at neighbouring slots, step by step, are a group, one
// in each lane. A stage's groups wait for earlier stages alone.
template <class Tree, class Limbs>
struct ChainsInLanes {
  static constexpr int most = 8;
  struct Group {
    int lanes = 1, slot = 0, steps = 0, stage = 0, chains = 0, chain[most] = {-1, -1, -1, -1, -1, -1, -1, -1};
    bool even = true;  // chains of one length
  };
  struct All {
    Group group[Tree::count] = {};
    int count = 0, stages = 0, of[Tree::count] = {};
  };

  // Lanes of the loop that left a chain's joints where they are; 1: none, or of its own.
  static constexpr int lanes_of(int c) {
    if constexpr (Limbs::in_slots) {
      const int first = Tree::first[c], length = Tree::length[c];
      if (c == 0 || length < 2) return 1;
      const int lanes = Limbs::slot(first + 1) - Limbs::slot(first);
      for (int k = 0; k < length; ++k)
        if (Limbs::slot(first + k) != Limbs::slot(first) + k * lanes) return 1;
      return lanes == 2 || lanes == 4 || lanes == 8 ? lanes : 1;
    } else {
      return static_cast<void>(c), 1;
    }
  }

  static constexpr All groups() {
    All all;
    for (int c = 0; c < Tree::count; ++c) {
      const int lanes = lanes_of(c);
      int slot = 0, found = 0;
      if constexpr (Limbs::in_slots) slot = lanes > 1 ? Limbs::slot(Tree::first[c]) : 0;
      while (found < all.count && (lanes < 2 || all.group[found].lanes != lanes || slot < all.group[found].slot ||
                                   slot >= all.group[found].slot + lanes))
        ++found;
      Group& group = all.group[found];
      if (found == all.count) ++all.count, group.lanes = lanes, group.slot = slot, group.steps = Tree::length[c];
      all.of[c] = found;
      group.even = group.even && group.steps == Tree::length[c];
      group.steps = Tree::length[c] > group.steps ? Tree::length[c] : group.steps;
      group.chain[slot - group.slot] = c;
      ++group.chains;
    }
    for (Group& group : all.group)
      if (group.chains < 2) group.lanes = 1;
    for (int again = 0; again < Tree::count; ++again)
      for (int c = 1; c < Tree::count; ++c) {
        const int stage = Tree::parent(c) < 0 ? 0 : all.group[all.of[Tree::parent(c)]].stage + 1;
        Group& group = all.group[all.of[c]];
        group.stage = stage > group.stage ? stage : group.stage;
        all.stages = group.stage > all.stages ? group.stage : all.stages;
      }
    ++all.stages;
    return all;
  }
  DALEMBERT_TABLE All value = groups();

  static constexpr int longest_of_stage(int stage) {
    int most_steps = 0;
    for (int g = 0; g < value.count; ++g)
      if (value.group[g].stage == stage && value.group[g].steps > most_steps) most_steps = value.group[g].steps;
    return most_steps;
  }
  static constexpr bool has_child(int c) {
    for (int other = 0; other < Tree::count; ++other)
      if (Tree::parent(other) == c) return true;
    return false;
  }
};

template <class T, int lanes>
struct TwistInLanes {
  Lanes<T, lanes> of[6];
};
template <class Groups, class T, class Numbers>
struct TwistsOfGroups;
template <class Groups, class T, int... g>
struct TwistsOfGroups<Groups, T, std::integer_sequence<int, g...>> {
  std::tuple<TwistInLanes<T, Groups::value.group[g].lanes>...> all;
};

// x = L^-1 x, M = L' D L, by articulated bodies from the base outwards: every coordinate moves by what it is less what the
// motion above makes it yield, and every body by that more. Groups of a stage side by side, for each waits for itself alone.
template <class Tree, class Limbs, class T>
static DALEMBERT_INLINE void accelerate_outwards(const Limbs& limbs, T* x) {
  constexpr int base = 6;
  using Groups = ChainsInLanes<Tree, Limbs>;
  T twist[Tree::count][base];  // of each chain's last body
  for_constants<base>([&](auto k) DALEMBERT_IN_BLOCK {
    T own = x[k];
    for_constants<decltype(k)::value>([&](auto i) DALEMBERT_IN_BLOCK { own -= limbs.base_gain(k, i) * x[i]; });
    twist[0][k] = x[k] = own;
  });
  TwistsOfGroups<Groups, T, std::make_integer_sequence<int, Groups::value.count>> moving;
  for_constants<Groups::value.stages>([&](auto of_stage) DALEMBERT_IN_BLOCK {
    constexpr int stage = decltype(of_stage)::value;
    const auto each_group = [&](const auto& f) DALEMBERT_IN_BLOCK {
      for_constants<Groups::value.count>([&](auto g) DALEMBERT_IN_BLOCK {
        if constexpr (Groups::value.group[decltype(g)::value].stage == stage) f(g);
      });
    };
    each_group([&](auto g) DALEMBERT_IN_BLOCK {
      constexpr int which = decltype(g)::value;
      constexpr auto& group = Groups::value.group[which];
      for_constants<base>([&](auto j) DALEMBERT_IN_BLOCK {
        std::get<which>(moving.all).of[j] = each_lane<group.lanes, T>([&](int lane) DALEMBERT_IN_BLOCK {
          const int c = group.chain[lane];
          return c < 0 ? T(0) : twist[Tree::parent(c) < 0 ? 0 : Tree::parent(c)][j];
        });
      });
    });
    const auto go_down = [&](int step) DALEMBERT_IN_BLOCK {
      each_group([&](auto g) DALEMBERT_IN_BLOCK {
        constexpr int which = decltype(g)::value;
        constexpr auto& group = Groups::value.group[which];
        constexpr int lanes = group.lanes;
        if (step >= group.steps) return;
        const auto at_joint = [&](const auto& joints) DALEMBERT_IN_BLOCK {  // deduced: joints in arrays have nothing beside
          if constexpr (lanes > 1) return joints.template beside<lanes>(group.slot + step * lanes);
          else return joints.at(Tree::first[group.chain[0]] + step);
        }(limbs);
        auto& moved = std::get<which>(moving.all).of;
        const auto own = each_lane<lanes, T>([&](int lane) DALEMBERT_IN_BLOCK {
          const int c = group.chain[lane];
          return c < 0 ? T(0) : x[Tree::first[c] + (group.even ? step : least(step, Tree::length[c] - 1))];
        });
        const auto yields = [&](int j) DALEMBERT_IN_BLOCK { return at_joint.gain(j) * moved[j]; };
        const auto first = yields(0) + yields(1), second = yields(2) + yields(3), third = yields(4) + yields(5);
        const Lanes<T, lanes> rate = (own - first) - (second + third);
        for_constants<lanes>([&](auto l) DALEMBERT_IN_BLOCK {
          constexpr int c = group.chain[decltype(l)::value];
          if constexpr (c >= 0)
            if (group.even || step < Tree::length[c]) x[Tree::first[c] + step] = lane<lanes, T>(rate, l);
        });
        for_constants<base>([&](auto j) DALEMBERT_IN_BLOCK {
          const Lanes<T, lanes> next = moved[j] + at_joint.axis(j) * rate;
          if constexpr (group.even) {
            moved[j] = next;
          } else {  // a chain that has ended keeps what its last body does
            moved[j] = each_lane<lanes, T>([&](int l) DALEMBERT_IN_BLOCK {
              const int c = group.chain[l];
              return c < 0 || step < Tree::length[c] ? lane<lanes, T>(next, l) : lane<lanes, T>(moved[j], l);
            });
          }
        });
      });
    };
    constexpr int from = stage == 0 ? base : 0, to = Groups::longest_of_stage(stage);
    if constexpr (from < to) {
      DALEMBERT_KEEP_LOOP
      for (int step = from; step < to; ++step) go_down(step);
    }
    each_group([&](auto g) DALEMBERT_IN_BLOCK {
      constexpr int which = decltype(g)::value;
      constexpr auto& group = Groups::value.group[which];
      for_constants<group.lanes>([&](auto l) DALEMBERT_IN_BLOCK {
        constexpr int c = group.chain[decltype(l)::value];
        if constexpr (c >= 0)
          if constexpr (Groups::has_child(c))
            for_constants<base>(
                [&](auto j) DALEMBERT_IN_BLOCK { twist[c][j] = lane<group.lanes, T>(std::get<which>(moving.all).of[j], l); });
      });
    });
  });
}

}  // namespace constraint_detail
}  // namespace dalembert
