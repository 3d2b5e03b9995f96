// The command line.
#pragma once

#include <cstdint>
#include <string>

namespace farm {

struct Options {
  std::string command;  // sweep, identify, record
  std::string out, recording;
  std::uint64_t items = 0, seed = 1, block = 65536;
  bool results_only = false;
  std::uint64_t steps = 200;  // of a recording
  bool help = false;
};

const char* usage();
Options read_options(int count, char** words);  // throws Error

}  // namespace farm
