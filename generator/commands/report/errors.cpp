#include "commands/report/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace dalembert::reporting {
namespace {

// The distance to the next number away from zero.
template <class Scalar>
double last_place(double value) {
  const Scalar x = static_cast<Scalar>(std::abs(value));
  return static_cast<double>(std::nextafter(x, std::numeric_limits<Scalar>::infinity()) - x);
}

}  // namespace

Error error_of(const Eigen::MatrixXd& result, const Eigen::MatrixXd& exact, double least_scale, ir::ScalarType scalar) {
  constexpr double infinite = std::numeric_limits<double>::infinity(), unknown = std::numeric_limits<double>::quiet_NaN();
  if (!exact.allFinite()) return {unknown, unknown, unknown};
  if (!result.allFinite()) return {infinite, infinite, infinite};
  const Eigen::ArrayXXd difference = (result - exact).array().abs();
  const double largest = difference.maxCoeff();
  if (largest == 0) return {};
  const double scale = std::max(exact.array().abs().maxCoeff(), least_scale);
  Error error;
  error.norm = largest / scale;
  error.ulp = largest / (scalar == ir::ScalarType::float32 ? last_place<float>(scale) : last_place<double>(scale));
  for (Eigen::Index i = 0; i < exact.size(); ++i)
    if (exact(i) != 0) error.component = std::max(error.component, difference(i) / std::abs(exact(i)));
  return error;
}

Change change_between(const Eigen::MatrixXd& before, const Eigen::MatrixXd& after, ir::ScalarType scalar) {
  const auto same = [&](Eigen::Index i) { return before(i) == after(i) || (std::isnan(before(i)) && std::isnan(after(i))); };
  Change change;
  Eigen::MatrixXd numbers = before, others = after;
  for (Eigen::Index i = 0; i < before.size(); ++i) {
    if (!same(i)) ++change.elements;
    else numbers(i) = others(i) = std::isfinite(before(i)) ? before(i) : 0;
  }
  if (change.elements == 0) return change;
  change.ulp = numbers.allFinite() ? error_of(others, numbers, 0, scalar).ulp : std::numeric_limits<double>::infinity();
  return change;
}

std::string Change::told() const {
  const std::string who = elements == 1 ? "1 element changes" : fmt::format("{:g} elements change", elements);
  if (!std::isfinite(ulp)) return who + " from a number to none or back";
  return fmt::format("{} by up to {:.2g} ulp of the largest", who, ulp);
}

Spread spread(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](size_t quarter) { return values[(values.size() - 1) * quarter / 4]; };
  return {at(1), at(2), at(3), values.back()};
}

}  // namespace dalembert::reporting
