// Independent pieces of work on all cores of the machine.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace dalembert {

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
    const std::size_t cores = std::max(1u, std::thread::hardware_concurrency());
    while (others.size() + 1 < std::min(cores, count)) others.emplace_back(run);
    run();
  }
  if (thrown) std::rethrow_exception(thrown);
}

}  // namespace dalembert
