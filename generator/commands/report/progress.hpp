// How far a long command is, on stderr, and how long the rest will take.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

namespace dalembert::reporting {

// On a terminal one line that changes, "report: compiling, 12 of 48, about 40 s left", and is gone at the end; elsewhere, as in
// a log, such a line per tenth of the work. May be stepped from several threads.
class Progress {
 public:
  Progress(std::string what, std::size_t count);
  ~Progress();
  Progress(const Progress&) = delete;
  void step();

 private:
  void say(std::size_t done);

  std::string what_;
  std::size_t count_;
  bool terminal_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::atomic<std::size_t> done_{0};
  std::mutex saying_;
  std::size_t said_ = 0;  // the most that was said to be done
};

// ", about 40 s left", of work that has taken so many seconds for so much of it; empty while that says nothing yet.
std::string time_left(double seconds, std::size_t done, std::size_t count);

}  // namespace dalembert::reporting
