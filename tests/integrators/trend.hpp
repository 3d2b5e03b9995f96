// What a curve does but for its oscillation.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace dalembert::testing {

// What the curve rises by from its beginning to its end: the means of its halves, under windows that fade out, stand half the
// time apart.
inline double trend(const std::vector<double>& curve) {
  const std::size_t half = curve.size() / 2;
  double weights = 0, difference = 0;
  for (std::size_t i = 0; i < half; ++i) {
    const double w = 1 - std::cos(2 * std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(half));
    weights += w;
    difference += w * (curve[half + i] - curve[i]);
  }
  return 2 * difference / weights;
}

}  // namespace dalembert::testing
