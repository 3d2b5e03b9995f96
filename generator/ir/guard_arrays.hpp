// What the guard of a function tells by what rounding may have left of M's pivots (dalembert/factor.hpp): U of M = U D U', or V
// and J of articulated bodies.
#pragma once

#include <string>

#include "ir/algorithm.hpp"

namespace dalembert::ir {

inline constexpr const char *own_factor = "factor", *own_gain = "gain", *own_joint = "joint";

// Arrays; −1: there is none.
struct GuardArrays {
  int factor = -1;            // nv × nv, above its diagonal
  int gain = -1, joint = -1;  // 6 × nv each, where there is no factor

  bool has(int array) const { return array >= 0 && (array == factor || array == gain || array == joint); }
};

// Of a function with a guard of its own, all of whose quantities are described.
inline GuardArrays guard_arrays(const Algorithm& algorithm) {
  const auto named = [&](const char* name) {
    for (std::size_t a = 0; a < algorithm.arrays.size(); ++a)
      if (algorithm.arrays[a].name == algorithm.own_name(name)) return static_cast<int>(a);
    return -1;
  };
  if (!algorithm.guard || algorithm.guard->pivots < 0) return {};
  if (algorithm.factor >= 0) return {algorithm.factor};
  if (const int factor = named(own_factor); factor >= 0) return {factor};
  return {-1, named(own_gain), named(own_joint)};
}

}  // namespace dalembert::ir
