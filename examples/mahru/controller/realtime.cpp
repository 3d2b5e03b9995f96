#include "realtime.hpp"

#include <sched.h>
#include <sys/mman.h>
#include <time.h>

#include <cerrno>
#include <cstring>

namespace controller {
namespace {

constexpr std::int64_t second = 1'000'000'000;

std::int64_t read_clock(clockid_t clock) noexcept {
  timespec t;
  clock_gettime(clock, &t);
  return t.tv_sec * second + t.tv_nsec;
}

}  // namespace

std::vector<std::string> enter_real_time() {
  std::vector<std::string> notices;
  sched_param parameters{};
  parameters.sched_priority = 80;
  if (sched_setscheduler(0, SCHED_FIFO, &parameters) != 0)
    notices.push_back(std::string("no SCHED_FIFO (") + std::strerror(errno) +
                      "): other programs may delay a tick; run as root or grant CAP_SYS_NICE");
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0)
    notices.push_back(std::string("no mlockall (") + std::strerror(errno) +
                      "): a page fault may delay a tick; run as root or raise `ulimit -l`");
  return notices;
}

std::int64_t now() noexcept { return read_clock(CLOCK_MONOTONIC); }
std::int64_t cpu_time() noexcept { return read_clock(CLOCK_THREAD_CPUTIME_ID); }

void sleep_until(std::int64_t time) noexcept {
  const timespec t{time / second, time % second};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
}

}  // namespace controller
