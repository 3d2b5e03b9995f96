// Rollouts, inside: a block of motions stays in registers' lanes from step to step, blocks in strips as in batch.hpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "dalembert/batch.hpp"
#include "dalembert/integrators/screws.hpp"
#include "dalembert/quaternion_joint.hpp"
#include "dalembert/rollout_layout.hpp"

namespace dalembert {

namespace detail {

// A motion of each lane: where it is, where the step leads, and what the stages of a step leave to later ones.
template <class T, int nq, int nv>
struct RolloutBlock {
  using V = BatchLanes<T>;
  V q[nq], v[nv], next_q[nq], next_v[nv], step[nv], change[nv], steps[nv], changes[nv];
  int stopped[batch_width<T>];
};

template <class T, int n, class V>
DALEMBERT_BLOCK void copy_numbers(const V* from, V* to) {
  for (int i = 0; i < n; ++i) to[i] = from[i];
}

// The joints with quaternions, as generated code lists them where there are any.
template <int n>
struct QuaternionJoints {
  static constexpr int count = n;
  const QuaternionJoint* at;
};
DALEMBERT_BLOCK QuaternionJoints<0> listed() { return {nullptr}; }
template <std::size_t n>
DALEMBERT_BLOCK QuaternionJoints<static_cast<int>(n)> listed(const QuaternionJoint (&joints)[n]) {
  return {joints};
}

// Of one motion: of_pose(first of q, of v) of a floating base and floating joints, of_turn of spherical ones, of_rest(first of
// q, of v, how many) of what adds.
template <int nq, int nv, int count, class Pose, class Turn, class Rest>
DALEMBERT_BLOCK void each_part_of_motion(const QuaternionJoints<count>& joints, const Pose& of_pose, const Turn& of_turn,
                                         const Rest& of_rest) {
  int at = 0, i = 0;
  if constexpr (nq != nv + count) {
    of_pose(0, 0);
    at = 7, i = 6;
  }
  for (int j = 0; j < count; ++j) {
    const QuaternionJoint& joint = joints.at[j];
    of_rest(at, i, joint.v - i);
    if (joint.slides) of_pose(joint.q, joint.v);
    else of_turn(joint.q, joint.v);
    at = joint.q + (joint.slides ? 7 : 4);
    i = joint.v + (joint.slides ? 6 : 3);
  }
  of_rest(at, i, nv - i);
}

// By the angles' squares, lane by lane: a lane's bits do not depend on the others.
template <class T>
DALEMBERT_BLOCK void screw_of_lanes(const BatchLanes<T>& squared, integrators::detail::Screw<BatchLanes<T>>& screw) {
  using namespace integrators::detail;
  screw_of_small<T>(squared, screw);
  int large = 0;
  for (int l = 0; l < batch_width<T>; ++l) large += lane<batch_width<T>, T>(squared, l) < T(small_square) ? 0 : 1;
  for (int l = 0; large > 0 && l < batch_width<T>; ++l) {
    const T own = lane<batch_width<T>, T>(squared, l);
    if (own < T(small_square)) continue;
    Screw<T> by_functions;
    screw_of_large(own, by_functions);
    put_state<T>(&by_functions.first, 1, l, &screw.first);
    put_state<T>(&by_functions.second, 1, l, &screw.second);
    put_state<T>(&by_functions.sine, 1, l, &screw.sine);
    put_state<T>(&by_functions.cosine, 1, l, &screw.cosine);
  }
}

// next = q · exp(step), and on a fixed base q + step.
template <class T, int nq, int nv, class... Joints>
DALEMBERT_BLOCK void move_lanes(const BatchLanes<T>* q, const BatchLanes<T>* step, BatchLanes<T>* next,
                                const Joints&... joints) {
  using namespace integrators::detail;
  Screw<BatchLanes<T>> screw;
  each_part_of_motion<nq, nv>(
      listed(joints...),
      [&](int at, int i) DALEMBERT_IN_BLOCK {
        screw_of_lanes<T>(square(step + i + 3), screw);
        move_pose_by(q + at, step + i, screw, next + at);
      },
      [&](int at, int i) DALEMBERT_IN_BLOCK {
        screw_of_lanes<T>(square(step + i), screw);
        turn_quaternion(q + at, step + i, screw, next + at);
      },
      [&](int at, int i, int some) DALEMBERT_IN_BLOCK {
        for (int j = 0; j < some; ++j) next[at + j] = q[at + j] + step[i + j];
      });
}

// rate: how `step` changes when q · exp(step) moves with `speed` (integrators::rate_of_step).
template <class T, int nq, int nv, class... Joints>
DALEMBERT_BLOCK void rate_lanes(const BatchLanes<T>* step, const BatchLanes<T>* speed, BatchLanes<T>* rate,
                                const Joints&... joints) {
  using namespace integrators::detail;
  each_part_of_motion<nq, nv>(
      listed(joints...), [&](int, int i) DALEMBERT_IN_BLOCK { rate_of_screw(step + i, speed + i, rate + i); },
      [&](int, int i) DALEMBERT_IN_BLOCK { rate_of_turn(step + i, speed + i, rate + i); },
      [&](int, int i, int some) DALEMBERT_IN_BLOCK {
        for (int j = i; j < i + some; ++j) rate[j] = speed[j];
      });
}

// What of a program's contacts and loops comes on and goes: how many, and the place of the first among what is given.
template <class Program, class = void>
struct Switched {
  static constexpr int count = 0, first = 0;
};
template <class Program>
struct Switched<Program, std::void_t<decltype(Program::constraints)>> {
  static constexpr int count = Program::constraints, first = Program::first_active;
};

// Impacts of the motions of a block in which something comes on; `before`: what acted in the last step. status: as impacts
// have it, -1 where there was none. Whether there were any.
template <class T, int nq, int nv, class Program, class Block, class V>
DALEMBERT_BLOCK bool strike_where_on(Program& program, Block& block, const V* before, const RolloutBlock<T, nq, nv>& motion,
                                     int states, int* status) {
  using On = Switched<Program>;
  bool any = false;
  for (int j = 0; j < batch_width<T>; ++j) status[j] = -1;
  for (int j = 0; j < states; ++j) {
    bool comes_on = false;
    for (int c = 0; c < On::count; ++c)
      comes_on |=
          lane<batch_width<T>, T>(block.given[On::first + c], j) > T(0) && !(lane<batch_width<T>, T>(before[c], j) > T(0));
    if (!comes_on || motion.stopped[j] >= 0) continue;
    status[j] = program.strike(block, j);
    any = true;
  }
  return any;
}

// Motions that cannot make the step stay where they are. began_v: v before an impact.
template <class T, int nq, int nv, class V>
DALEMBERT_BLOCK void accept_step(RolloutBlock<T, nq, nv>& motion, const V* began_v, const int* status, std::size_t step) {
  constexpr int w = batch_width<T>;
  V not_finite{};  // x − x is zero of a finite number, and NaN of others
  for (int i = 0; i < nq; ++i) not_finite += motion.next_q[i] - motion.next_q[i];
  for (int i = 0; i < nv; ++i) not_finite += motion.next_v[i] - motion.next_v[i];
  bool stays = false;
  for (int j = 0; j < w; ++j) {
    const bool bad = status[j] >= 0 || !(lane<w, T>(not_finite, j) == T(0));
    if (motion.stopped[j] < 0 && bad) motion.stopped[j] = static_cast<int>(step);
    stays |= motion.stopped[j] >= 0;
  }
  if (__builtin_expect(stays, 0))
    for (int j = 0; j < w; ++j) {
      if (motion.stopped[j] < 0) continue;
      T q[nq], v[nv];
      take_state<T>(motion.q, nq, j, q);
      take_state<T>(began_v, nv, j, v);
      put_state<T>(q, nq, j, motion.next_q);
      put_state<T>(v, nv, j, motion.next_v);
    }
  copy_numbers<T, nq>(motion.next_q, motion.q);
  copy_numbers<T, nv>(motion.next_v, motion.v);
}

}  // namespace detail

// What a rollout has to be, beyond what a batch has to be. linearly_implicit, impacts: whether the code has them.
template <bool linearly_implicit = false, bool impacts = false, class T>
static inline BatchError check_rollout(const Rollout<T>& rollout, const T* input, std::size_t count, int nq) noexcept {
  if (static_cast<unsigned>(rollout.method) > static_cast<unsigned>(RolloutMethod::linearly_implicit))
    return BatchError::method;
  if (rollout.method == RolloutMethod::linearly_implicit && !linearly_implicit) return BatchError::left_out;
  if (!std::isfinite(rollout.time_step)) return BatchError::time_step;
  if (rollout.active && !impacts) return BatchError::active;
  if (rollout.control && (input || rollout.active)) return BatchError::control;
  constexpr std::size_t most = std::numeric_limits<std::size_t>::max() / 2 / sizeof(double);
  const std::size_t numbers = static_cast<std::size_t>(nq + 10);
  if (rollout.steps > static_cast<std::size_t>(std::numeric_limits<int>::max()) ||
      (rollout.steps > 0 && count > most / numbers / rollout.steps - 16))
    return BatchError::steps;
  return BatchError::none;
}

// The motions from `first` up to `end`. Program: as in run_batch(); with_given(block, first state, how many) reads all but q, v
// and the input. finish(block): behind run(), its status. v̇ stands at values + acceleration. layout: of the input and the
// states.
template <int nq, int nv, class T, class Program, class Finish, class... Joints>
static inline void roll_out(Program&& program, const Rollout<T>& rollout, const T* q, const T* v, const T* input,
                            BatchLayout states_in, BatchLayout results_in, std::size_t first, std::size_t end, int acceleration,
                            const Finish& finish, const Joints&... joints) noexcept {
  using P = std::decay_t<Program>;
  using Block = typename P::Block;
  using V = BatchLanes<T>;
  constexpr int w = batch_width<T>, strip = P::strip;
  using On = detail::Switched<P>;
  Block blocks[strip];
  V began_v[On::count > 0 ? strip : 1][nv];
  bool struck[strip] = {};
  int of_impact[On::count > 0 ? strip : 1][w] = {};
  detail::RolloutBlock<T, nq, nv> motions[strip];
  const V h = broadcast<w, T>(rollout.time_step);
  for (Block& block : blocks) {
    for (V& x : block.values) x = V{};  // lanes of no motion, which a program may leave alone, move by numbers too
    for (int& s : block.status) s = -1;
  }
  while (first < end) {
    std::size_t at[strip] = {};  // g++ 12 does not see that `count` of them are set
    int states[strip] = {}, count = 0;
    for (; first < end && count < strip; first += static_cast<std::size_t>(w), ++count) {
      at[count] = first;
      states[count] = end - first < static_cast<std::size_t>(w) ? static_cast<int>(end - first) : w;
      read_states<nq, T>(q, states_in, first, states[count], motions[count].q);
      read_states<nv, T>(v, states_in, first, states[count], motions[count].v);
      blocks[count].states = states[count];
      program.with_given(blocks[count], first, states[count]);
      for (V& x : blocks[count].input) x = V{};  // what the motions before had is not theirs
      for (int& s : motions[count].stopped) s = -1;
    }
    // v̇ of all blocks, at the positions and velocities that stand in them.
    const auto accelerate = [&] {
      program.run(blocks, count);
      for (int b = 0; b < count; ++b) finish(blocks[b]);
    };
    for (std::size_t step = 0; step < rollout.steps; ++step) {
      for (int b = 0; b < count; ++b) {
        Block& block = blocks[b];
        detail::copy_numbers<T, nq>(motions[b].q, block.q);
        detail::copy_numbers<T, nv>(motions[b].v, block.v);
        [[maybe_unused]] V* const active = On::count > 0 ? block.given + On::first : nullptr;
        V before[On::count > 0 ? On::count : 1];
        if constexpr (On::count > 0) {
          detail::copy_numbers<T, On::count>(active, before);
          if (rollout.active)
            read_states<On::count, T>(rollout.active, states_in, at[b], states[b], active, rollout.steps * On::count,
                                      step * On::count);
        }
        if (input) {
          read_states<nv, T>(input, states_in, at[b], states[b], block.input, rollout.steps * nv, step * nv);
        } else if (rollout.control) {
          rollout.control(
              {at[b], states[b], w, step, reinterpret_cast<const T*>(motions[b].q), reinterpret_cast<const T*>(motions[b].v),
               reinterpret_cast<T*>(block.input), reinterpret_cast<T*>(active)},
              rollout.user);
        }
        if constexpr (On::count > 0) {
          struck[b] = detail::strike_where_on<T, nq, nv>(program, block, before, motions[b], states[b], of_impact[b]);
          if (struck[b])
            detail::copy_numbers<T, nv>(motions[b].v, began_v[b]), detail::copy_numbers<T, nv>(block.v, motions[b].v);
        }
      }
      int status[strip][w];
      for (int b = 0; b < count; ++b)
        for (int j = 0; j < w; ++j) status[b][j] = struck[b] ? of_impact[On::count > 0 ? b : 0][j] : -1;
      const auto keep_status = [&] {
        for (int b = 0; b < count; ++b)
          for (int j = 0; j < w; ++j) status[b][j] = std::max(status[b][j], blocks[b].status[j]);
      };
      if (rollout.method != RolloutMethod::rk4) {  // a linearly implicit step is the same, with v̇ of its own program
        accelerate();
        keep_status();
        for (int b = 0; b < count; ++b) {
          auto& m = motions[b];
          const V* const a = blocks[b].values + acceleration;
          for (int i = 0; i < nv; ++i) m.next_v[i] = m.v[i] + h * a[i], m.step[i] = h * m.next_v[i];
          detail::move_lanes<T, nq, nv>(m.q, m.step, m.next_q, joints...);
        }
      } else {
        // As integrators::rk4(): a stage at q · exp(step), v + change.
        const T t = rollout.time_step, forward[] = {t / 2, t / 2, t, T(0)}, weight[] = {t / 6, t / 3, t / 3, t / 6};
        for (int b = 0; b < count; ++b)
          for (int i = 0; i < nv; ++i)
            motions[b].step[i] = motions[b].change[i] = motions[b].steps[i] = motions[b].changes[i] = V{};
        for (int stage = 0; stage < 4; ++stage) {
          accelerate();
          keep_status();
          const V ahead = broadcast<w, T>(forward[stage]), share = broadcast<w, T>(weight[stage]);
          for (int b = 0; b < count; ++b) {
            auto& m = motions[b];
            Block& block = blocks[b];
            const V* const a = block.values + acceleration;
            V rate[nv];
            detail::rate_lanes<T, nq, nv>(m.step, block.v, rate, joints...);
            for (int i = 0; i < nv; ++i) {
              m.steps[i] += share * rate[i], m.changes[i] += share * a[i];
              m.step[i] = ahead * rate[i], m.change[i] = ahead * a[i];
            }
            if (stage == 3) continue;
            detail::move_lanes<T, nq, nv>(m.q, m.step, block.q, joints...);
            for (int i = 0; i < nv; ++i) block.v[i] = m.v[i] + m.change[i];
          }
        }
        for (int b = 0; b < count; ++b) {
          auto& m = motions[b];
          detail::move_lanes<T, nq, nv>(m.q, m.steps, m.next_q, joints...);
          for (int i = 0; i < nv; ++i) m.next_v[i] = m.v[i] + m.changes[i];
        }
      }
      for (int b = 0; b < count; ++b) {
        detail::accept_step<T, nq, nv>(motions[b], struck[b] ? began_v[On::count > 0 ? b : 0] : motions[b].v, status[b], step);
        const auto write = [&](const V* values, int numbers, T* to) {
          if (!to) return;
          const auto k = static_cast<std::size_t>(numbers);
          write_states<T>(values, nullptr, numbers, results_in, at[b], states[b], to, rollout.steps * k, step * k);
        };
        write(motions[b].q, nq, rollout.path_q);
        write(motions[b].v, nv, rollout.path_v);
      }
    }
    for (int b = 0; b < count; ++b) {
      if (rollout.last_q) write_states<T>(motions[b].q, nullptr, nq, results_in, at[b], states[b], rollout.last_q);
      if (rollout.last_v) write_states<T>(motions[b].v, nullptr, nv, results_in, at[b], states[b], rollout.last_v);
      for (int j = 0; rollout.stopped && j < states[b]; ++j)
        rollout.stopped[at[b] + static_cast<std::size_t>(j)] = motions[b].stopped[j];
    }
  }
}

}  // namespace dalembert
