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
    VectorX<S> row(n), l(n);  // of a row what is not zero: elements of a row are far apart, those of a column side by side
    std::vector<Eigen::Index> above;
    bool all_hold = true;
    for (Eigen::Index k = n - 1; k >= 0; --k) {
      const S pivot = factors_(k, k);
      all_hold = all_hold && pivot > dalembert::detail::least_ratio<S>() * diagonal[k] && pivot > S(0);
      above.clear();
      for (Eigen::Index i = 0; i < k; ++i) {
        row[i] = factors_(k, i);
        l[i] = factors_(k, i) /= pivot;
        if (row[i] != S(0)) above.push_back(i);
      }
      for (auto j = above.begin(); j != above.end(); ++j)
        for (auto i = j; i != above.end(); ++i) factors_(*i, *j) -= l[*i] * row[*j];
    }
    if (!all_hold) status_ = bounded_status(diagonal);
  }

  const FactorStatus<S>& status() const { return status_; }

  // M⁻¹ b, b: n × any number of columns.
  MatrixX<S> solve(MatrixX<S> b) const {
    const Eigen::Index n = factors_.rows();
    const MatrixX<S> u = upper();
    // Joints that do not move each other's bodies have zeros, most of all where branches are many.
    for (Eigen::Index column = 0; column < b.cols(); ++column) {
      auto x = b.col(column);
      for (Eigen::Index k = n - 1; k >= 0; --k) {
        if (x[k] == S(0)) continue;
        for (Eigen::Index i = 0; i < k; ++i)
          if (u(i, k) != S(0)) x[i] -= u(i, k) * x[k];
      }
      for (Eigen::Index k = 0; k < n; ++k) x[k] /= factors_(k, k);
      for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index k = i + 1; k < n; ++k)
          if (factors_(k, i) != S(0)) x[k] -= factors_(k, i) * x[i];
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
