// How long a call takes, and how much that moves from one measurement to the next.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <string>

namespace dalembert {

struct CallTime {
  double median = 0, lower_quartile = 0, upper_quartile = 0;  // of the means, ns per call
};

// Three digits of a time in ns, in the unit that leaves no fourth before the point: "245 ns", "1.15 µs", "12 ms".
inline std::string time_text(double nanoseconds) {
  const char* unit = "ns";
  for (const char* larger : {"µs", "ms", "s"}) {
    if (nanoseconds < 999.5) break;
    nanoseconds /= 1000;
    unit = larger;
  }
  return fmt::format("{:.3g} {}", nanoseconds, unit);
}

// Calls call(0) … call(count − 1) in turn, again and again for some hundredths of a second: after a warm-up, 201 means of about
// 0.1 ms each, or of one turn where that is longer. Of calls so slow that this would take seconds, fewer means.
template <class Call>
CallTime time_calls(std::size_t count, const Call& call) {
  using Clock = std::chrono::steady_clock;
  const auto elapsed = [](Clock::time_point start) {
    return std::chrono::duration<double, std::nano>(Clock::now() - start).count();
  };
  const auto mean = [&](int rounds) {
    const Clock::time_point start = Clock::now();
    for (int r = 0; r < rounds; ++r)
      for (std::size_t i = 0; i < count; ++i) call(i);
    return elapsed(start) / rounds / static_cast<double>(count);
  };
  constexpr std::size_t most_means = 201, fewest_means = 5;
  constexpr double warm_up = 2e7, mean_time = 1e5, most_time = 4e8;  // ns; the clock's own cost is lost in a mean
  const Clock::time_point start = Clock::now();
  double estimate = mean(1);
  while (elapsed(start) < warm_up) estimate = mean(1);
  const int rounds = 1 + static_cast<int>(mean_time / (estimate * static_cast<double>(count) + 1));
  std::array<double, most_means> means;
  const Clock::time_point measuring = Clock::now();
  std::size_t n = 0;
  while (n < most_means && (n < fewest_means || elapsed(measuring) < most_time)) means[n++] = mean(rounds);
  std::sort(means.begin(), means.begin() + static_cast<std::ptrdiff_t>(n));
  return {means[n / 2], means[n / 4], means[3 * n / 4]};
}

}  // namespace dalembert
