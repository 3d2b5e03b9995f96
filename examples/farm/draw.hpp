// Numbers drawn by number: the k-th of item i is a function of seed, i and k alone.
#pragma once

#include <cstdint>

namespace farm {

// SplitMix64's mixing of 64 bits (Steele, Lea, Flood, OOPSLA 2014).
inline std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

class Draw {
 public:
  Draw(std::uint64_t seed, std::uint64_t item) : state_(mixed(mixed(seed + golden) + item * golden)) {}
  // Uniform between low and high: of 53 bits.
  double operator()(double low, double high) {
    state_ += golden;
    return low + (high - low) * static_cast<double>(mixed(state_) >> 11) * 0x1p-53;
  }

 private:
  static constexpr std::uint64_t golden = 0x9e3779b97f4a7c15u;
  std::uint64_t state_;
};

}  // namespace farm
