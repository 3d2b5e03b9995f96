// How far a result is from the exact one, in the three ways a report tells it.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "ir/scene.hpp"

namespace dalembert::reporting {

struct Error {
  double norm = 0;       // largest difference over the largest exact element (or `least_scale`, where that is larger)
  double ulp = 0;        // the same difference in units of the last place of that element, in the scalar
  double component = 0;  // largest difference of an element over that exact element, exact zeros left out
};

// Of one result, rows × columns. A result that is not finite where the exact one is, is infinitely wrong; where the exact one
// is not finite either, the error is NaN.
Error error_of(const Eigen::MatrixXd& result, const Eigen::MatrixXd& exact, double least_scale, ir::ScalarType scalar);

// How two results differ that should be the same bit by bit (but for the sign of zero and for NaN).
struct Change {
  double elements = 0;  // that are not the same number
  double ulp = 0;       // largest difference, in units of the last place of the largest element; infinite: one lost its number

  std::string told() const;  // in words
};
Change change_between(const Eigen::MatrixXd& before, const Eigen::MatrixXd& after, ir::ScalarType scalar);

// One number of many, by its rank.
struct Spread {
  double lower_quartile = 0, median = 0, upper_quartile = 0, worst = 0;
};

// Of a list that is not empty.
Spread spread(std::vector<double> values);

}  // namespace dalembert::reporting
