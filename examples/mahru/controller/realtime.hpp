// Clocks, and what makes Linux keep to them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace controller {

// Asks for SCHED_FIFO and locks memory. Returns one plain notice for each thing that was not permitted; the controller runs all
// the same.
std::vector<std::string> enter_real_time();

std::int64_t now() noexcept;                   // ns, CLOCK_MONOTONIC
std::int64_t cpu_time() noexcept;              // ns this thread has been computing, CLOCK_THREAD_CPUTIME_ID
void sleep_until(std::int64_t time) noexcept;  // ns, CLOCK_MONOTONIC; returns at once when the time is past

}  // namespace controller
