// A whole-body controller: MAHRU stands on both feet and moves its centre of mass.
//
// Accelerations are those nearest to a spring and a damper towards a posture that keep the feet where they are and give the
// momentum h = A v the rate that brings the centre of mass to its target. Torques and forces at the feet follow from the
// equations of motion: the base's six say what the feet bear, the joints' what the motors do.
#pragma once

#include <Eigen/Cholesky>

#include "standing_mahru/dynamics.hpp"

namespace whole_body {

using standing_mahru::nv, standing_mahru::VectorQ, standing_mahru::VectorV;
constexpr int joints = standing_mahru::joints;
using Vector12 = Eigen::Matrix<double, 12, 1>;
using Vector18 = Eigen::Matrix<double, 18, 1>;

// [the law]
struct Controller {
  standing_mahru::Workspace robot;
  VectorQ posture;
  Vector12 forces = Vector12::Zero();  // at the left and the right foot, world-aligned axes, N and N m

  // The joints' torques at a state, for the centre of mass to go to `target` (m, world).
  Eigen::Matrix<double, joints, 1> torques(const VectorQ& q, const VectorV& v, const Eigen::Vector3d& target) {
    standing_mahru::evaluate(q, v, robot);
    const auto M = standing_mahru::mass_matrix(robot);
    const auto A = standing_mahru::momentum_matrix(robot);
    Eigen::Matrix<double, 12, nv> J;  // of both feet
    J << standing_mahru::jacobian_mixed_left_foot(robot), standing_mahru::jacobian_mixed_right_foot(robot);

    // G v' = rate: the feet stay, the momentum changes as it should.
    Eigen::Matrix<double, 18, nv> G;
    Vector18 rate;
    G << J, A;
    rate << -standing_mahru::acceleration_bias_mixed_left_foot(robot),
        -standing_mahru::acceleration_bias_mixed_right_foot(robot),
        25 * M(0, 0) * (target - standing_mahru::center_of_mass(robot)), Eigen::Vector3d::Zero();
    rate.head<12>() -= 20 * J * v;
    rate.tail<6>() -= standing_mahru::momentum_bias(robot) + 10 * A * v;

    // Of all such v' the one nearest to a spring and a damper towards the posture.
    VectorV a = VectorV::Zero();
    a.tail<joints>() = 100 * (posture - q).tail<joints>() - 20 * v.tail<joints>();
    a += G.transpose() * (G * G.transpose()).llt().solve(rate - G * a);

    // What the base lacks the feet bear, by the least forces that do.
    const VectorV needed = M * a + standing_mahru::bias(robot);
    const auto of_base = J.leftCols<6>();
    forces = of_base * (of_base.transpose() * of_base).llt().solve(needed.head<6>());
    return needed.tail<joints>() - J.rightCols<joints>().transpose() * forces;
  }
};
// [end of the law]

}  // namespace whole_body
