// What stops a run: said once on stderr, exit status 2.
#pragma once

#include <stdexcept>
#include <string>

namespace farm {

// The message names the file or the argument, what is wrong with it, and what to do.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The same with what the system says of `number` (errno).
Error system_error(const std::string& file, const std::string& what, int number);

}  // namespace farm
