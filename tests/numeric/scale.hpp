// What an error is measured against: the largest element of the quantity.
//
// Where a robot makes a quantity vanish (C of a single revolute joint on the ground, of a gantry), its largest element is
// rounding noise of larger terms that cancel. So C counts as at least a thousandth of |M| |v|, and the bias as at least a
// thousandth of |M| |v|².
#pragma once

#include <dalembert/generic/dynamics.hpp>
#include <limits>

namespace dalembert::testing {

template <class Matrix>
typename Matrix::Scalar largest(const Matrix& matrix) {
  return matrix.size() == 0 ? typename Matrix::Scalar(0) : matrix.cwiseAbs().maxCoeff();
}

template <class S>
struct Scale {
  S mass_matrix, coriolis_matrix, gravity, bias, wrench_influence;

  Scale(const generic::Dynamics<S>& result, const VectorX<S>& v)
      : mass_matrix(largest(result.mass_matrix)),
        coriolis_matrix(std::max<S>(largest(result.coriolis_matrix), mass_matrix * largest(v) / 1000)),
        gravity(largest(result.gravity)),
        bias(std::max<S>(largest(result.bias), mass_matrix * largest(v) * largest(v) / 1000)),
        wrench_influence(largest(result.wrench_influence)) {}
};

// |a − b| / scale; the difference itself when the scale is zero; infinity when anything is not a number.
template <class A, class B, class S>
double relative_error(const A& a, const B& b, const S& scale) {
  const auto difference = (a - b).eval();
  if ((difference.array() != difference.array()).any()) return std::numeric_limits<double>::infinity();
  const S error = largest(difference);
  return static_cast<double>(scale > 0 ? S(error / scale) : error);
}

}  // namespace dalembert::testing
