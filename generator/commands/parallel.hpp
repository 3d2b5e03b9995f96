// Independent pieces of work on all cores that this process may use.
#pragma once

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace dalembert {

// At least one; fewer than the machine has where a container or taskset says so.
inline std::size_t usable_cores() {
  cpu_set_t cores;
  if (sched_getaffinity(0, sizeof cores, &cores) == 0) return std::max<std::size_t>(1, CPU_COUNT(&cores));
  return std::max(1u, std::thread::hardware_concurrency());
}

// Runs work(0) … work(count − 1), each once, in no order. The first exception among those thrown ends the rest and is thrown.
template <class Work>
void each_in_parallel(std::size_t count, const Work& work) {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  std::exception_ptr thrown;
  const auto run = [&] {
    for (std::size_t i; !failed && (i = next++) < count;) try {
        work(i);
      } catch (...) {
        if (!failed.exchange(true)) thrown = std::current_exception();
      }
  };
  {
    std::vector<std::jthread> others;
    const std::size_t at_once = std::min(usable_cores(), count);
    while (others.size() + 1 < at_once) others.emplace_back(run);
    run();
  }
  if (thrown) std::rethrow_exception(thrown);
}

}  // namespace dalembert
