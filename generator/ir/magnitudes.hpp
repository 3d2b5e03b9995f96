// How large a number of a robot or scene may be.
#pragma once

#include "ir/scene.hpp"

namespace dalembert::ir {

// Beyond this, products such as mass · length² · rate² come near the end of double's range; no robot is near it. In float, for
// robots that are computed in it, constants are products of at most three.
inline constexpr double largest_number = 1e60, largest_number_in_float = 1e12;

inline double largest_of(ScalarType scalar) { return scalar == ScalarType::float32 ? largest_number_in_float : largest_number; }
// "1e+60", and of float why.
inline const char* largest_in_words(ScalarType scalar) {
  return scalar == ScalarType::float32 ? "1e+12, too large for float" : "1e+60";
}

}  // namespace dalembert::ir
