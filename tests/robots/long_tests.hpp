// What sh tests/run.sh has no time for.
#pragma once

#include <cstdlib>
#include <vector>

namespace dalembert {

// In tests/long.sh, and wherever CMake was told DALEMBERT_LONG_TESTS.
inline bool long_tests() { return std::getenv("DALEMBERT_LONG_TESTS") != nullptr; }

// All cases in the long run, one in `n` otherwise.
template <class Cases>
std::vector<typename Cases::value_type> one_in(int n, const Cases& all) {
  std::vector<typename Cases::value_type> some;
  int number = 0;
  for (const auto& each : all)
    if (long_tests() || number++ % n == 0) some.push_back(each);
  return some;
}

}  // namespace dalembert
