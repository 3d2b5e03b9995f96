#include "sole.hpp"

#include <cmath>
#include <limits>

namespace standing {

SoleUse sole_use(const Eigen::Matrix<double, 6, 1>& wrench, double mu, double X, double Y) noexcept {
  const double tangential = std::hypot(wrench[0], wrench[1]), pressing = wrench[2];
  const double tipping = std::fmax(std::fabs(wrench[4]) / X, std::fabs(wrench[3]) / Y);
  constexpr double none = 1e-9;  // N
  if (pressing <= none) {
    const auto any = [](double size) { return size > none ? std::numeric_limits<double>::infinity() : 0; };
    return {any(tangential), any(tipping)};
  }
  return {tangential / (mu * pressing), tipping / pressing};
}

}  // namespace standing
