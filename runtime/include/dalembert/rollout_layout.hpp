// Rollouts: many motions at once, from many states on. What callers say; rollout.hpp is what the code itself includes.
#pragma once

#include <cstddef>

#include "dalembert/batch_layout.hpp"

namespace dalembert {

// How a step leads on, as the integrators of the same names do; what acts stays the same during a step.
enum class RolloutMethod : int {
  semi_implicit_euler,  // the new speeds move the positions; of first order, one evaluation a step
  rk4,                  // of fourth order, four evaluations
  // Of first order; stiff dampers and springs of the robot's joints come to rest instead of blowing up. Where the scene asks
  // for it: rollouts: [linearly_implicit].
  linearly_implicit,
};

// A block of motions before a step: number i of the block's motion number k stands at [i * stride + k], and k is less than
// `count`. What is written to `input` acts during the step: nv numbers of each motion, N and N m; it begins with zeros, and
// stays from step to step where nothing is written. `active`, where the scene asks for impacts, else null: which contacts and
// loops act, 1 or 0 each, in the order of their rows; as before where nothing is written.
template <class T>
struct RolloutStep {
  std::size_t first;  // of the batch's motions, the one that the block begins with
  int count, stride;
  std::size_t step;  // 0 is the first
  const T *q, *v;
  T* input;
  T* active;
};

// A batch's states are where motions begin. Its input is what acts in each step: steps × nv numbers a motion, step by step; or
// there is a function that says it, or, with neither, nothing acts. Results are written where there is a pointer, laid out as
// the batch's results.
template <class T>
struct Rollout {
  std::size_t steps = 0;
  T time_step = T(0);  // s; may be negative
  RolloutMethod method = RolloutMethod::semi_implicit_euler;
  void (*control)(const RolloutStep<T>&, void* user) = nullptr;  // must not throw; where the batch has no input
  void* user = nullptr;
  // Of constrained_forward_dynamics, where the scene asks for it, rollouts: [impacts]: which contacts and loops act in each
  // step, 1 or 0: steps × so many numbers a motion, laid out as the batch's states. Null: as `control` says, or as the
  // workspace does. Where one comes on that did not act in the step before (before the first: in the workspace), the step
  // begins with an impact, of all that act now, with their restitution.
  const T* active = nullptr;

  T* last_q = nullptr;  // nq numbers a motion, behind the last step
  T* last_v = nullptr;  // nv
  T* path_q = nullptr;  // steps × nq: behind each step
  T* path_v = nullptr;  // steps × nv
  // Of each motion: the step, from 0, that it did not make, because M was not positive definite or a number would not have been
  // finite; −1: it made all of them. It stays where it was before that step, and no other motion changes.
  int* stopped = nullptr;
};

}  // namespace dalembert
