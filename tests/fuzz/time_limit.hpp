// One second of processor time for one input. libFuzzer's own limit counts the time a busy machine does not run it.
#pragma once

#include <signal.h>
#include <sys/time.h>

#include <cstdio>
#include <cstdlib>

namespace dalembert::fuzz {

class TimeLimit {
 public:
  TimeLimit() {
    ::signal(SIGPROF, [](int) {
      std::fputs("takes longer than a second\n", stderr);
      std::abort();
    });
    set(1);
  }
  ~TimeLimit() { set(0); }
  TimeLimit(const TimeLimit&) = delete;
  TimeLimit& operator=(const TimeLimit&) = delete;

 private:
  static void set(int seconds) {
    const itimerval time{{0, 0}, {seconds, 0}};
    setitimer(ITIMER_PROF, &time, nullptr);
  }
};

}  // namespace dalembert::fuzz
