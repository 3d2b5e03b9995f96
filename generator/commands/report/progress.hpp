// How far a long command is, on stderr.
#pragma once

#include <atomic>
#include <cstddef>
#include <string>

namespace dalembert::reporting {

// A line per tenth of the work: "report: compiling, 12 of 48". May be stepped from several threads.
class Progress {
 public:
  Progress(std::string what, std::size_t count);
  void step();

 private:
  std::string what_;
  std::size_t count_;
  std::atomic<std::size_t> done_{0};
};

}  // namespace dalembert::reporting
