// A small dense quadratic program of fixed size:
//
//     least ½ xᵀ H x + gᵀ x    with    lower ≤ A x ≤ upper
//
// H is positive definite; a bound may be infinite, a row's two may be equal. Solved by Goldfarb and Idnani's dual method
// (Mathematical Programming 27, 1983): it begins at the least of all x, whatever the rows say, and takes in the row that is
// violated most until none is. So it needs no feasible point to start from, ends after as many steps as rows come to bind, and
// one or two more, and finds out where no x satisfies all rows. Nothing here allocates, throws or depends on what was solved
// before.
//
// Costs: n³ for the factor of H, then per step 6 n² and a product with A.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>

namespace standing {

enum class QpStatus {
  solved,
  infeasible,    // the rows contradict each other; x satisfies those taken in so far
  not_convex,    // H is not positive definite, or something is not a number
  out_of_steps,  // rounding keeps it from an end: never seen
};

template <int n, int rows>
class Qp {
 public:
  using Vector = Eigen::Matrix<double, n, 1>;
  using Rows = Eigen::Matrix<double, rows, 1>;

  // What is asked.
  Eigen::Matrix<double, n, n> H;  // the lower triangle is read
  Vector g;
  Eigen::Matrix<double, rows, n, Eigen::RowMajor> A;
  Rows lower, upper;

  // What is answered.
  Vector x;
  Rows multipliers;  // H x + g = Aᵀ multipliers; not below zero at a lower bound, not above at an upper one, zero elsewhere
  int steps = 0;     // rows taken in and put out

  // tolerance: how much a row may be violated, of its bound and of its length times that of x (times 1 where x is shorter).
  QpStatus solve(double tolerance = 1e-10) noexcept {
    multipliers.setZero();
    active_ = steps = 0;
    if (!start()) return QpStatus::not_convex;
    for (int i = 0; i < rows; ++i) {
      length_[i] = A.row(i).norm();
      if (!(length_[i] < std::numeric_limits<double>::infinity())) return QpStatus::not_convex;
      if (!(lower[i] <= upper[i])) return QpStatus::infeasible;
    }

    while (true) {
      Vector normal;  // of the row to be taken in, and how far x is outside of it: normalᵀ x is to rise by `missing`
      double missing;
      const int row = most_violated(tolerance, normal, missing);
      if (row < 0) break;
      double multiplier = 0;
      while (true) {
        if (++steps > 20 * (n + rows)) return QpStatus::out_of_steps;
        // In the basis J, whose first `active_` columns span the active rows: what of the normal is new, and what it is in
        // terms of the active rows.
        d_.noalias() = J_.transpose() * normal;
        double rise = 0;  // of normalᵀ x per unit of the multiplier
        for (int k = active_; k < n; ++k) rise += d_[k] * d_[k];
        const bool dependent = active_ == n || rise <= 1e-20 * d_.squaredNorm();
        for (int i = active_ - 1; i >= 0; --i) {
          r_[i] = d_[i];
          for (int k = i + 1; k < active_; ++k) r_[i] -= R_(i, k) * r_[k];
          r_[i] /= R_(i, i);
        }

        // The multiplier grows until the row is met, or until the multiplier of an active row has fallen to zero.
        double longest = std::numeric_limits<double>::infinity();
        int leaving = -1;
        for (int i = 0; i < active_; ++i)
          if (r_[i] > 0 && u_[i] < longest * r_[i]) longest = u_[i] / r_[i], leaving = i;
        const double full = dependent ? std::numeric_limits<double>::infinity() : missing / rise;
        if (leaving < 0 && dependent) return QpStatus::infeasible;
        const double step = std::fmin(longest, full);

        for (int i = 0; i < active_; ++i) u_[i] -= step * r_[i];
        multiplier += step;
        if (!dependent) {
          for (int k = active_; k < n; ++k) x += step * d_[k] * J_.col(k);
          missing -= step * rise;
        }
        if (full <= longest) {
          take_in(row, multiplier, normal.dot(A.row(row)) < 0);
          settle();
          break;
        }
        put_out(leaving);
      }
    }
    for (int i = 0; i < active_; ++i) multipliers[row_[i]] = at_upper_[i] ? -u_[i] : u_[i];
    return x.allFinite() ? QpStatus::solved : QpStatus::not_convex;
  }

 private:
  // J = L⁻ᵀ with H = L Lᵀ, and x = −H⁻¹ g.
  bool start() noexcept {
    Eigen::Matrix<double, n, n> L;
    for (int j = 0; j < n; ++j) {
      double pivot = H(j, j);
      for (int k = 0; k < j; ++k) pivot -= L(j, k) * L(j, k);
      if (!(pivot > 1e-14 * H(j, j))) return false;  // no pivot of a number that is none
      L(j, j) = std::sqrt(pivot);
      for (int i = j + 1; i < n; ++i) {
        double sum = H(i, j);
        for (int k = 0; k < j; ++k) sum -= L(i, k) * L(j, k);
        L(i, j) = sum / L(j, j);
      }
    }
    J_.setZero();
    for (int j = 0; j < n; ++j) {  // row j of J is column j of L⁻¹
      J_(j, j) = 1 / L(j, j);
      for (int i = j + 1; i < n; ++i) {
        double sum = 0;
        for (int k = j; k < i; ++k) sum += L(i, k) * J_(j, k);
        J_(j, i) = -sum / L(i, i);
      }
    }
    d_.noalias() = J_.transpose() * g;
    x.noalias() = -(J_ * d_);
    return x.allFinite();
  }

  int most_violated(double tolerance, Vector& normal, double& missing) noexcept {
    const Rows values = A * x;
    const double size = std::fmax(1, x.norm());
    double worst = 0;
    int row = -1;
    bool below = true;
    for (int i = 0; i < rows; ++i) {
      const double under = lower[i] - values[i], over = values[i] - upper[i], violated = std::fmax(under, over);
      const double bound = under > over ? lower[i] : upper[i];
      if (!(violated > tolerance * (length_[i] * size + std::fabs(bound))) || is_active(i, under > over)) continue;
      const double distance = length_[i] > 0 ? violated / length_[i] : std::numeric_limits<double>::infinity();
      if (distance > worst) worst = distance, row = i, below = under > over;
    }
    if (row < 0) return row;
    normal = A.row(row);
    missing = lower[row] - values[row];
    if (!below) normal = -normal, missing = values[row] - upper[row];
    return row;
  }

  // A row that is active on that side is met but for rounding.
  bool is_active(int row, bool below) const noexcept {
    for (int i = 0; i < active_; ++i)
      if (row_[i] == row && at_upper_[i] != below) return true;
    return false;
  }

  // Turns columns a and b of J such that of (a, b) the second becomes 0.
  void turn(int column, double& a, double& b) noexcept {
    const double length = std::hypot(a, b);
    if (length == 0) return;
    const double c = a / length, s = b / length;
    for (int i = 0; i < n; ++i) {
      const double first = J_(i, column), second = J_(i, column + 1);
      J_(i, column) = c * first + s * second;
      J_(i, column + 1) = c * second - s * first;
    }
    a = length, b = 0;
  }

  void take_in(int row, double multiplier, bool at_upper) noexcept {
    for (int k = n - 2; k >= active_; --k) turn(k, d_[k], d_[k + 1]);
    for (int i = 0; i <= active_; ++i) R_(i, active_) = d_[i];
    row_[active_] = row, u_[active_] = multiplier, at_upper_[active_] = at_upper;
    ++active_;
  }

  // x and the multipliers of the active rows by themselves, not as what steps from far away have added up to:
  // x = J (y, −J₂ᵀ g) with Rᵀ y = bounds, R u = y + J₁ᵀ g.
  void settle() noexcept {
    d_.noalias() = J_.transpose() * g;
    for (int i = 0; i < active_; ++i) {
      r_[i] = at_upper_[i] ? -upper[row_[i]] : lower[row_[i]];
      for (int k = 0; k < i; ++k) r_[i] -= R_(k, i) * r_[k];
      r_[i] /= R_(i, i);
    }
    for (int i = active_ - 1; i >= 0; --i) {
      double sum = r_[i] + d_[i];
      for (int k = i + 1; k < active_; ++k) sum -= R_(i, k) * u_[k];
      u_[i] = std::fmax(0, sum / R_(i, i));
    }
    for (int i = 0; i < n; ++i) d_[i] = i < active_ ? r_[i] : -d_[i];
    x.noalias() = J_ * d_;
  }

  void put_out(int which) noexcept {
    for (int j = which; j + 1 < active_; ++j) {
      for (int i = 0; i <= j + 1; ++i) R_(i, j) = R_(i, j + 1);
      row_[j] = row_[j + 1], u_[j] = u_[j + 1], at_upper_[j] = at_upper_[j + 1];
    }
    --active_;
    for (int j = which; j < active_; ++j) {
      // R has an element below its diagonal in column j; the rotation that removes it acts on the later columns too.
      const double length = std::hypot(R_(j, j), R_(j + 1, j));
      if (length == 0) continue;
      const double c = R_(j, j) / length, s = R_(j + 1, j) / length;
      for (int k = j + 1; k < active_; ++k) {
        const double first = R_(j, k), second = R_(j + 1, k);
        R_(j, k) = c * first + s * second;
        R_(j + 1, k) = c * second - s * first;
      }
      turn(j, R_(j, j), R_(j + 1, j));
    }
  }

  Eigen::Matrix<double, n, n> J_;  // Jᵀ H J = 1; its first columns span the active rows' normals
  Eigen::Matrix<double, n, n> R_;  // active normals = H J R
  Vector d_, r_, u_;               // u: multipliers of the active rows, in the order they were taken in
  Eigen::Matrix<int, n, 1> row_;
  Eigen::Matrix<bool, n, 1> at_upper_;
  Rows length_;
  int active_ = 0;
};

}  // namespace standing
