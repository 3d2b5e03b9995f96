#include "reference.hpp"

#include <algorithm>
#include <cmath>

namespace controller {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double fade_in = 1.0;             // s
constexpr double largest_amplitude = 0.35;  // rad

struct Fade {
  double r, dr, ddr;
};

// r = 10 x³ − 15 x⁴ + 6 x⁵, the lowest polynomial with zero first and second derivatives at both ends.
Fade fade(double t) {
  if (t >= fade_in) return {1, 0, 0};
  const double x = t / fade_in;
  return {x * x * x * (10 + x * (6 * x - 15)), 30 * x * x * (x - 1) * (x - 1) / fade_in,
          60 * x * (x - 1) * (2 * x - 1) / (fade_in * fade_in)};
}

}  // namespace

Reference::Reference(const VectorJ& lower, const VectorJ& upper) {
  for (int i = 0; i < joints; ++i) {
    amplitude_[i] = std::min(largest_amplitude, 0.4 * (upper[i] - lower[i]));
    centre_[i] = std::clamp(0.0, lower[i] + amplitude_[i], upper[i] - amplitude_[i]);
    frequency_[i] = 2 * pi * (0.4 + 0.6 * i / (joints - 1));
    phase_[i] = 2.4 * i;  // the golden angle, nearly: phases spread evenly
  }
}

void Reference::at(double t, Target& target) const noexcept {
  const Fade f = fade(t);
  for (int i = 0; i < joints; ++i) {
    const double w = frequency_[i], s = std::sin(w * t + phase_[i]), c = std::cos(w * t + phase_[i]);
    const double p = centre_[i] + amplitude_[i] * s, dp = amplitude_[i] * w * c, ddp = -amplitude_[i] * w * w * s;
    target.q[i] = f.r * p;
    target.v[i] = f.dr * p + f.r * dp;
    target.a[i] = f.ddr * p + 2 * f.dr * dp + f.r * ddp;
  }
}

}  // namespace controller
