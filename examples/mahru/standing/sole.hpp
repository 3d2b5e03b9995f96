// What a rectangular sole can exert on the ground without tipping, slipping or turning.
//
// A wrench is possible if forces at the four corners add up to it, each of them inside a pyramid of friction |f_x|, |f_y| ≤ µ
// f_z. These wrenches (f, m), about the middle of a sole of half sizes X and Y, are those of S. Caron, Q.-C. Pham and Y.
// Nakamura, Stability of surface contacts for humanoid robots, ICRA 2015:
//
//     |f_x|, |f_y| ≤ µ f_z      |m_x| ≤ Y f_z      |m_y| ≤ X f_z
//     |Y f_x ∓ µ m_x| + |X f_y ∓ µ m_y| ≤ µ (X + Y) f_z ± m_z
//
// The second line is where the centre of pressure lies inside the sole, the third is what the corners' friction leaves to turn
// the foot. Each is linear: 16 rows.
#pragma once

#include <Eigen/Core>

namespace standing {

inline constexpr int sole_rows = 16;

// The matrix C with C (f, m) ≥ 0 for exactly these wrenches. Rows are about 1 long for forces in N and moments in N m.
inline Eigen::Matrix<double, sole_rows, 6> sole_constraints(double mu, double X, double Y) {
  Eigen::Matrix<double, sole_rows, 6> C;
  int row = 0;
  for (const int s : {-1, 1}) {
    C.row(row++) << s, 0, mu, 0, 0, 0;
    C.row(row++) << 0, s, mu, 0, 0, 0;
    C.row(row++) << 0, 0, Y, s, 0, 0;
    C.row(row++) << 0, 0, X, 0, s, 0;
  }
  for (const int turn : {-1, 1})
    for (const int s : {-1, 1})
      for (const int t : {-1, 1}) C.row(row++) << s * Y, t * X, mu * (X + Y), -turn * s * mu, -turn * t * mu, turn;
  return C;
}

// How much of that a wrench uses: 1 at the edge, 0 for a force straight through the middle. The friction is that of the round
// cone. Without a pressing force 0 for no wrench and infinity for any.
struct SoleUse {
  double friction;  // √(f_x² + f_y²) / (µ f_z)
  double pressure;  // of the centre of pressure: max(|m_y| / (X f_z), |m_x| / (Y f_z))
};
SoleUse sole_use(const Eigen::Matrix<double, 6, 1>& wrench, double mu, double X, double Y) noexcept;

}  // namespace standing
