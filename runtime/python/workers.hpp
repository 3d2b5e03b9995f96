// Threads that share the states of a batch.
#pragma once

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace dalembert::python {

// As many as there are cores this process may use, the caller's own among them; started at the first batch that is worth it.
// They live until the process ends. A child of fork() has none of them, and starts its own.
class Workers {
 public:
  static Workers& instance() {
    std::call_once(once(), [] {
      current() = new Workers;
      // The parent's threads, and what they hold, are not in the child.
      pthread_atfork(nullptr, nullptr, [] {
        const int count = current()->count();
        current() = new Workers;
        current()->set_count(count);
      });
    });
    return *current();
  }

  int count() const { return count_.load(std::memory_order_relaxed); }
  void set_count(int count) { count_.store(count, std::memory_order_relaxed); }

  // Calls work(w) with w from 0 to `threads` - 1, each on a thread of its own, the last on the caller's, and returns when all
  // have returned. One after another where somebody else's batch has the threads, or the system gives no more of them.
  void run(int threads, const std::function<void(int)>& work) {
    std::unique_lock<std::mutex> mine(busy_, std::try_to_lock);
    if (!mine.owns_lock() || threads <= 1) {
      for (int w = 0; w < threads; ++w) work(w);
      return;
    }
    int others = threads - 1;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      try {
        while (static_cast<int>(threads_.size()) < others)
          threads_.emplace_back([this, w = static_cast<int>(threads_.size())] { serve(w); }).detach();
      } catch (const std::exception&) {
        others = static_cast<int>(threads_.size());
      }
      work_ = &work;
      asked_ = others;
      left_ = others;
      ++turn_;
    }
    wake_.notify_all();
    for (int w = others; w < threads; ++w) work(w);
    std::unique_lock<std::mutex> lock(mutex_);
    done_.wait(lock, [this] { return left_ == 0; });
    work_ = nullptr;
  }

 private:
  static std::once_flag& once() {
    static std::once_flag flag;
    return flag;
  }
  static Workers*& current() {
    static Workers* workers = nullptr;
    return workers;
  }

  Workers() {
    cpu_set_t set;
    count_ = std::max(1, sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1);
  }

  void serve(int w) {
    std::size_t seen = 0;
    for (;;) {
      const std::function<void(int)>* work;
      {
        std::unique_lock<std::mutex> lock(mutex_);
        wake_.wait(lock, [&] { return turn_ != seen; });
        seen = turn_;
        if (w >= asked_) continue;
        work = work_;
      }
      (*work)(w);
      const std::lock_guard<std::mutex> lock(mutex_);
      if (--left_ == 0) done_.notify_one();
    }
  }

  std::atomic<int> count_{1};
  std::mutex busy_, mutex_;
  std::condition_variable wake_, done_;
  std::vector<std::thread> threads_;
  const std::function<void(int)>* work_ = nullptr;
  std::size_t turn_ = 0;
  int asked_ = 0, left_ = 0;
};

}  // namespace dalembert::python
