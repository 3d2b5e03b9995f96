#include "commands/report/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <utility>

#include "diagnostics.hpp"

namespace dalembert::reporting {

namespace {
constexpr const char* erase_line = "\r\033[K";
}

std::string time_left(double seconds, std::size_t done, std::size_t count) {
  if (seconds < 1 || done == 0 || done >= count) return "";
  const double left = seconds / static_cast<double>(done) * static_cast<double>(count - done);
  return left < 90 ? fmt::format(", about {:.0f} s left", std::ceil(left)) : fmt::format(", about {:.0f} min left", left / 60);
}

Progress::Progress(std::string what, std::size_t count)
    : what_(std::move(what)), count_(count), terminal_(isatty(STDERR_FILENO) == 1) {
  if (terminal_) say(0);
  else tell(fmt::format("report: {}, {} to do\n", what_, count_));
}

Progress::~Progress() {
  if (terminal_) tell(erase_line);
}

void Progress::step() {
  const std::size_t done = ++done_;
  if (terminal_ || done * 10 / count_ != (done - 1) * 10 / count_) say(done);
}

void Progress::say(std::size_t done) {
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  const std::lock_guard lock(saying_);
  if (done < said_) return;  // another thread was faster
  said_ = done;
  tell(fmt::format("{}report: {}, {} of {}{}{}", terminal_ ? erase_line : "", what_, done, count_,
                   time_left(seconds, done, count_), terminal_ ? "" : "\n"));
}

}  // namespace dalembert::reporting
