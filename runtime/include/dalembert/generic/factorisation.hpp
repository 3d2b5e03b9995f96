// M = Lᵀ D L, L unit lower triangular: eliminating from the last coordinate to the first, leaves before roots, makes no fill-in
// where M is zero because neither of two joints moves the other's body.
//
// Source: Featherstone, "Rigid Body Dynamics Algorithms" (2008), section 6.5. D_k, the pivot of coordinate k, is the inertia
// that joint k feels when all later joints are free: that of the articulated body.
#pragma once

#include <dalembert/factor.hpp>
#include <dalembert/spatial.hpp>
#include <numeric>
#include <vector>

namespace dalembert::generic {

// What comes of solving with M: meaningful when status.ok(), of no elements otherwise.
template <class Value>
struct Solution {
  Value value;
  FactorStatus<typename Value::Scalar> status;
};

template <class S>
class Factorisation {
 public:
  // M: symmetric, of which the lower triangle is read. Nothing may be solved unless status().ok(), which says what FactorStatus
  // does: bounds are computed where a pivot is small beside M's diagonal element.
  explicit Factorisation(MatrixX<S> M) : factors_(std::move(M)) {
    const Eigen::Index n = factors_.rows();
    const VectorX<S> diagonal = factors_.diagonal();
    bool all_hold = true;
    for (Eigen::Index k = n - 1; k >= 0; --k) {
      const S pivot = factors_(k, k);
      all_hold = all_hold && pivot > dalembert::detail::least_ratio<S>() * diagonal[k] && pivot > S(0);
      for (Eigen::Index i = 0; i < k; ++i) {
        if (factors_(k, i) == S(0)) continue;
        const S l = factors_(k, i) / pivot;
        for (Eigen::Index j = 0; j <= i; ++j) factors_(i, j) -= l * factors_(k, j);
      }
      factors_.row(k).head(k) /= pivot;
    }
    if (!all_hold) status_ = bounded_status(diagonal);
  }

  const FactorStatus<S>& status() const { return status_; }

  // M⁻¹ b, b: n × any number of columns.
  MatrixX<S> solve(MatrixX<S> b) const {
    const Eigen::Index n = factors_.rows();
    // Joints that do not move each other's bodies have zeros, most of all where branches are many.
    for (Eigen::Index k = n - 1; k >= 0; --k)
      for (Eigen::Index i = 0; i < k; ++i)
        if (factors_(k, i) != S(0)) b.row(i) -= factors_(k, i) * b.row(k);
    for (Eigen::Index k = 0; k < n; ++k) {
      b.row(k) /= factors_(k, k);
      for (Eigen::Index i = 0; i < k; ++i)
        if (factors_(k, i) != S(0)) b.row(k) -= factors_(k, i) * b.row(i);
    }
    return b;
  }

  // U = Lᵀ above the diagonal, D on it, zero below: M = U D Uᵀ.
  MatrixX<S> upper() const {
    MatrixX<S> result = factors_.template triangularView<Eigen::Lower>().transpose();
    return result;
  }

 private:
  // Where no coordinate is known to be beyond another each counts as beyond the one before it.
  FactorStatus<S> bounded_status(const VectorX<S>& diagonal) const {
    const int n = static_cast<int>(factors_.rows());
    std::vector<int> above(static_cast<std::size_t>(n));
    std::iota(above.begin(), above.end(), -1);
    const VectorX<S> pivots = factors_.diagonal();
    const MatrixX<S> factor = upper();
    VectorX<S> x(n);
    return dalembert::detail::bounded_status<S>(n, above.data(), factor.data(), pivots.data(), diagonal.data(), x.data());
  }

  MatrixX<S> factors_;  // D on the diagonal, L below it
  FactorStatus<S> status_;
};

}  // namespace dalembert::generic
