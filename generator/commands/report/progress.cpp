#include "commands/report/progress.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <utility>

namespace dalembert::reporting {

Progress::Progress(std::string what, std::size_t count) : what_(std::move(what)), count_(count) {
  fmt::print(stderr, "report: {}, {} to do\n", what_, count_);
}

void Progress::step() {
  const std::size_t done = ++done_;
  if (done * 10 / count_ != (done - 1) * 10 / count_) fmt::print(stderr, "report: {}, {} of {}\n", what_, done, count_);
}

}  // namespace dalembert::reporting
