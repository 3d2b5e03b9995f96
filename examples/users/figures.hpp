// What the examples print: errors with their bounds, and what a call takes.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>

class Figures {
 public:
  // Prints an error and its bound, and remembers where it is not below it (which no NaN is).
  void bounded(const char* what, double value, double bound, const char* unit) {
    const bool good = value < bound;
    std::printf("%-58s %9.2e %-8s below %.0e%s\n", what, value, unit, bound, good ? "" : ": NO");
    if (!good) exit_status_ = 1;
  }

  // Prints the time of one call: the median of eleven batches of a thousand.
  template <class Call>
  void timed(const char* what, Call call) {
    using Clock = std::chrono::steady_clock;
    constexpr int calls = 1000;
    std::array<double, 11> batches;
    for (double& batch : batches) {
      const auto start = Clock::now();
      for (int i = 0; i < calls; ++i) call();
      batch = std::chrono::duration<double, std::nano>(Clock::now() - start).count() / calls;
    }
    std::nth_element(batches.begin(), batches.begin() + batches.size() / 2, batches.end());
    std::printf("%-58s %9.0f ns a call\n", what, batches[batches.size() / 2]);
  }

  int exit_status() const { return exit_status_; }

 private:
  int exit_status_ = 0;
};
