// A static graph of tasks on oneTBB: built once, run many times. The only header that needs oneTBB.
//
// oneTBB lends the threads; which task runs next is decided here, since tasks take microseconds and a message of oneTBB's own
// flow graph costs a good part of one. The thread that calls takes tasks like any other: what threads that come late have not
// begun it does itself, so that a worker whose core is lent out holds up what it has begun and no more. Who calls may run in a
// task of oneTBB's itself: while it waits, it takes no other task of the caller's, which might call with the same workspace.
#pragma once

#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <utility>
#include <vector>

#include "happens_before.hpp"
#include "pause.hpp"

namespace dalembert {

// Tasks are numbered in the order they are added, which is one that they can run in: a task comes after some of those before
// it. A thread takes the first of those that it ran the last time, for what they write is in its cache; then the first of all.
class TaskGraph {
 public:
  // `threads`: the most that are of use.
  explicit TaskGraph(int threads = 1 << 10) : threads_(threads) {}
  TaskGraph(const TaskGraph&) = delete;
  TaskGraph& operator=(const TaskGraph&) = delete;

  // Returns the task's number.
  int add(std::function<void()> work) {
    const int number = static_cast<int>(tasks_.size());
    tasks_.emplace_back();
    tasks_.back().work = std::move(work);
    if (number % bits == 0) ready_.emplace_back(0), first_.push_back(0);
    first_.back() |= bit(number);
    return number;
  }

  // `after` runs when `before` has; before < after.
  void edge(int before, int after) {
    task(before).then.push_back(after);
    ++task(after).comes_after;
    first_[static_cast<std::size_t>(after / bits)] &= ~bit(after);
  }

  // Runs every task once and returns when all are done.
  void run() {
    int threads = tbb::this_task_arena::max_concurrency();
    if (threads > threads_) threads = threads_;
    if (threads < 2 || tasks_.size() < 2) {
      for (Task& t : tasks_) t.work();
      return;
    }
    for (Task& t : tasks_) t.waits_for.store(t.comes_after, std::memory_order_relaxed);
    left_.store(static_cast<int>(tasks_.size()), std::memory_order_relaxed);
    for (std::size_t word = 0; word < ready_.size(); ++word) ready_[word].store(first_[word], std::memory_order_release);
    detail::happens_before(&helpers_);
    tbb::this_task_arena::isolate([this, threads] {
      for (int i = 1; i < threads; ++i)
        helpers_.run([this] {
          detail::happens_after(&helpers_);
          take_part();
          detail::happens_before(this);
        });
      take_part();
      helpers_.wait();
    });
    detail::happens_after(this);
  }

 private:
  static constexpr int bits = 64, none = -1;

  struct Task {
    std::function<void()> work;
    std::vector<int> then;
    int comes_after = 0;
    alignas(64) std::atomic<int> waits_for{0};
    std::atomic<int> ran_on{none};  // thread, the last time
  };

  static std::uint64_t bit(int number) { return std::uint64_t{1} << (number % bits); }
  Task& task(int number) { return tasks_[static_cast<std::size_t>(number)]; }

  void take_part() {
    const int thread = tbb::this_task_arena::current_thread_index();
    while (left_.load(std::memory_order_acquire) > 0) {
      int next = claim(thread);
      if (next == none) next = claim(none);
      if (next == none) detail::pause();
      while (next != none) next = finish(next, thread);
    }
  }

  // A task that nobody else has, and that ran on the thread, if it is to be one of these; none: there is none now.
  int claim(int thread) {
    for (std::size_t word = 0; word < ready_.size(); ++word)
      for (std::uint64_t left = ready_[word].load(std::memory_order_acquire); left != 0; left &= left - 1) {
        const int number = static_cast<int>(word) * bits + __builtin_ctzll(left);
        if (thread != none && task(number).ran_on.load(std::memory_order_relaxed) != thread) continue;
        const std::uint64_t before = ready_[word].fetch_and(~bit(number), std::memory_order_acq_rel);
        if (before & bit(number)) return number;  // else another was faster
      }
    return none;
  }

  // Runs it, and tells those that waited for it. Returns one of these that may run now, whose numbers are still in the caches.
  int finish(int number, int thread) {
    Task& t = task(number);
    t.ran_on.store(thread, std::memory_order_relaxed);
    t.work();
    int next = none;
    for (const int after : t.then) {
      if (task(after).waits_for.fetch_sub(1, std::memory_order_acq_rel) != 1) continue;
      if (next == none && task(after).ran_on.load(std::memory_order_relaxed) == thread) next = after;
      else ready_[static_cast<std::size_t>(after / bits)].fetch_or(bit(after), std::memory_order_release);
    }
    left_.fetch_sub(1, std::memory_order_acq_rel);
    return next;
  }

  const int threads_;
  std::deque<Task> tasks_;
  std::deque<std::atomic<std::uint64_t>> ready_;  // of each task: it can run, and nobody has begun it
  std::vector<std::uint64_t> first_;              // … when all begins
  std::atomic<int> left_{0};                      // not done
  tbb::task_group helpers_;
};

}  // namespace dalembert
