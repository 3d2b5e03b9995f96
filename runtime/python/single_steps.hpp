// Motions of a function that has no batch, or whose contacts come on and go: one after another, by its single states.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <dalembert/integrators/rk4.hpp>
#include <dalembert/integrators/semi_implicit_euler.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "arguments.hpp"
#include "function.hpp"

namespace dalembert::python {

// Numbers of each step: (steps, size) for all motions, or (n, steps, size).
struct PerStep {
  Argument array;  // its owner, and how many motions there are
  const void* first = nullptr;
  std::ptrdiff_t motion = 0, step = 0, number = 0;  // in numbers
  npy_intp steps = -1;                              // -1: there are none
};

// Contacts and loops that come on and go.
struct Switching {
  PerStep active;              // which act in each step, 1 or 0; none: as the run-time inputs say, all the time
  std::vector<int> places;     // of each `active`, among the run-time inputs
  Contents* impact = nullptr;  // the function that tells what an impact does
  int impact_result = 0;       // and which of its results
};

template <class T>
class SingleSteps {
 public:
  using Vector = Eigen::Matrix<T, Eigen::Dynamic, 1>;
  std::vector<QuaternionJoint> quaternion_joints;

  SingleSteps(const Contents& f, const Switching& switching, const RolloutCall& call, std::vector<QuaternionJoint> joints,
              void* workspace, void* impact_workspace)
      : quaternion_joints(std::move(joints)),
        f_(f),
        switching_(switching),
        call_(call),
        motion_of_(f, workspace),
        input_(f.nv) {
    if (switching.impact) impact_of_.emplace(*switching.impact, impact_workspace);
    for (const RunTimeInput& input : f.run_time_inputs) given_.resize(given_.size() + static_cast<std::size_t>(input.size));
  }

  Vector acceleration(const Vector& q, const Vector& v) { return result(motion_of_, f_.acceleration, q, v); }

  void run() {
    const auto steps = static_cast<std::ptrdiff_t>(call_.steps);
    const auto h = static_cast<T>(call_.time_step);
    const auto read = [](const StateRows& rows, std::ptrdiff_t motion, npy_intp size) {
      return Vector(Eigen::Map<const Vector>(static_cast<const T*>(rows.first) + motion * rows.step, size));
    };
    const auto write = [](const Vector& from, void* to, std::ptrdiff_t row) {
      if (to) std::copy_n(from.data(), from.size(), static_cast<T*>(to) + row * from.size());
    };
    for (std::ptrdiff_t motion = call_.begin; motion < call_.end; ++motion) {
      Vector q = read(call_.q, motion, f_.nq), v = read(call_.v, motion, f_.nv);
      if (!given_.empty())
        std::copy_n(static_cast<const T*>(call_.run_time.first) + motion * call_.run_time.step, given_.size(), given_.begin());
      std::int32_t stopped = -1;
      for (std::ptrdiff_t step = 0; step < steps; ++step) {
        if (stopped < 0) {
          const T* const acts = static_cast<const T*>(call_.more);
          for (npy_intp i = 0; i < f_.nv; ++i)
            input_[i] = acts ? acts[motion * call_.more_motion + step * call_.more_step + i * call_.more_number] : T(0);
          Vector next_q = q, next_v = v;
          worst_ = -1;
          if (something_comes_on(motion, step)) next_v = result(*impact_of_, switching_.impact_result, q, v);
          if (call_.method == RolloutMethod::rk4) integrators::rk4(*this, h, next_q, next_v);
          else integrators::semi_implicit_euler(*this, h, next_q, next_v);
          if (worst_ >= 0 || !next_q.allFinite() || !next_v.allFinite()) stopped = static_cast<std::int32_t>(step);
          else q = next_q, v = next_v;
        }
        write(q, call_.path_q, motion * steps + step);
        write(v, call_.path_v, motion * steps + step);
      }
      write(q, call_.last_q, motion);
      write(v, call_.last_v, motion);
      call_.stopped[motion] = stopped;
    }
  }

 private:
  // A function, where its results go, and its workspace.
  struct Called {
    Called(const Contents& f, void* of) : entry(f.single.entry), workspace(of) {
      for (const Shape& shape : f.shapes) results.emplace_back(static_cast<std::size_t>(shape.size[0] * shape.size[1]));
      for (std::vector<T>& r : results) pointers.push_back(r.data());
    }
    const FunctionEntry* entry;
    void* workspace;
    std::vector<std::vector<T>> results;
    std::vector<void*> pointers;
  };

  Vector result(Called& of, int number, const Vector& q, const Vector& v) {
    FunctionCall one{};
    one.q.first = q.data(), one.v.first = v.data(), one.more.first = input_.data(), one.run_time.first = given_.data();
    std::int32_t status = -1;
    one.results = of.pointers.data(), one.status = of.entry->has_status ? &status : nullptr, one.end = 1;
    of.entry->run(one, of.workspace);
    worst_ = std::max(worst_, status);
    return Eigen::Map<const Vector>(of.results[static_cast<std::size_t>(number)].data(), f_.nv);
  }

  // What acts in the step, and whether any of it did not in the step before: before the first, as the run-time inputs say.
  bool something_comes_on(std::ptrdiff_t motion, std::ptrdiff_t step) {
    const PerStep& active = switching_.active;
    if (active.steps < 0) return false;
    bool any = false;
    const T* number = static_cast<const T*>(active.first) + motion * active.motion + step * active.step;
    for (const int place : switching_.places) {
      T& acts = given_[static_cast<std::size_t>(place)];
      any |= *number > T(0) && !(acts > T(0));
      acts = *number > T(0) ? T(1) : T(0);
      number += active.number;
    }
    return any;
  }

  const Contents& f_;
  const Switching& switching_;
  const RolloutCall& call_;
  Called motion_of_;
  std::optional<Called> impact_of_;
  Vector input_;
  std::vector<T> given_;  // the run-time inputs
  std::int32_t worst_ = -1;
};

}  // namespace dalembert::python
