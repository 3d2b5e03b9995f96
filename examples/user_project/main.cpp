// Two generated robots in one program: the arm from C++, the cart-pole from C.
#include <Eigen/Cholesky>
#include <cmath>
#include <cstdio>

#include "arm/dynamics.hpp"

extern "C" int try_cart_pole();

namespace {

// Accelerations of the arm without torques, against the textbook's two-link formulas; 0 when they agree.
int try_arm() {
  const arm::VectorQ q(0.4, -1.1);
  const arm::VectorV v(0.5, 2.0);
  arm::Workspace workspace;
  arm::evaluate(q, v, workspace);
  const Eigen::Vector2d acceleration = arm::mass_matrix(workspace).llt().solve(-arm::bias(workspace));

  const double m = 2, l = 1, c = 0.5, I = m * l * l / 12, g0 = 9.81;
  const double q1 = q[q_index(arm::Joint::shoulder)], q2 = q[q_index(arm::Joint::elbow)];
  const double v1 = v[v_index(arm::Joint::shoulder)], v2 = v[v_index(arm::Joint::elbow)];
  const double h = m * l * c * std::cos(q2), k = m * l * c * std::sin(q2);
  Eigen::Matrix2d M;
  M << 2 * (I + m * c * c) + m * l * l + 2 * h, I + m * c * c + h, I + m * c * c + h, I + m * c * c;
  const Eigen::Vector2d bias(-k * v2 * (2 * v1 + v2) + g0 * (m * (c + l) * std::sin(q1) + m * c * std::sin(q1 + q2)),
                             k * v1 * v1 + g0 * m * c * std::sin(q1 + q2));
  const double error = (acceleration + M.llt().solve(bias)).norm() / acceleration.norm();
  std::printf("arm, in C++: accelerates by %.6f and %.6f rad/s^2, differs from the textbook by %.1e\n", acceleration[0],
              acceleration[1], error);
  return error < 1e-12 ? 0 : 1;
}

}  // namespace

int main() { return try_arm() + try_cart_pole(); }
