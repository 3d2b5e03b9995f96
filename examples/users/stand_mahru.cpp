// A whole-body controller at work: MAHRU stands on both feet and carries its centre of mass 3 cm to the left and 2 cm down, in
// ticks of 1 ms. The feet are welded to the ground in the simulation, which solves M, Jᵀ and J for accelerations and forces at
// once; what the controller takes the forces to be is compared with that.
#include <Eigen/LU>
#include <cmath>
#include <dalembert/integrators/rk4.hpp>

#include "figures.hpp"
#include "whole_body.hpp"

namespace {

using namespace whole_body;
using standing_mahru::Joint;

// The robot on its feet, as the integrator wants it.
struct Ground {
  standing_mahru::Workspace robot;
  VectorV torques = VectorV::Zero();
  Vector12 forces = Vector12::Zero();

  VectorV acceleration(const VectorQ& q, const VectorV& v) {
    standing_mahru::evaluate(q, v, robot);
    Eigen::Matrix<double, 12, nv> J;
    J << standing_mahru::jacobian_mixed_left_foot(robot), standing_mahru::jacobian_mixed_right_foot(robot);
    Eigen::Matrix<double, nv + 12, nv + 12> system;
    system << standing_mahru::mass_matrix(robot), -J.transpose(), J, Eigen::Matrix<double, 12, 12>::Zero();
    Eigen::Matrix<double, nv + 12, 1> right;
    right << torques - standing_mahru::bias(robot), -standing_mahru::acceleration_bias_mixed_left_foot(robot),
        -standing_mahru::acceleration_bias_mixed_right_foot(robot);
    const Eigen::Matrix<double, nv + 12, 1> both = system.partialPivLu().solve(right);
    forces = both.tail<12>();
    return both.head<nv>();
  }
};

}  // namespace

int main() {
  VectorQ q = VectorQ::Zero();
  q[6] = 1;
  for (const auto& [joint, angle] : {std::pair{Joint::left_hip_pitch, -0.4},
                                     {Joint::left_knee, 0.8},
                                     {Joint::left_ankle_pitch, -0.4},
                                     {Joint::right_hip_pitch, -0.4},
                                     {Joint::right_knee, 0.8},
                                     {Joint::right_ankle_pitch, -0.4}})
    q[q_index(joint)] = angle;
  VectorV v = VectorV::Zero();

  Controller controller;
  controller.posture = q;
  Ground ground;
  ground.acceleration(q, v);
  const Eigen::Vector3d start = standing_mahru::center_of_mass(ground.robot);
  const Eigen::Vector3d target = start + Eigen::Vector3d(0, 0.03, -0.02);
  const Eigen::Matrix<double, 3, 4> foot = standing_mahru::pose_left_foot(ground.robot);
  const double weight = 9.81 * standing_mahru::mass_matrix(ground.robot)(0, 0);

  double least = weight, difference = 0, foot_off = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    ground.torques.tail<joints>() = controller.torques(q, v, target);
    ground.acceleration(q, v);
    difference = std::fmax(difference, (ground.forces - controller.forces).norm());
    least = std::fmin(least, std::fmin(ground.forces[2], ground.forces[8]));
    if (!ground.torques.allFinite()) difference = std::nan("");
    dalembert::integrators::rk4(ground, 1e-3, q, v);
    foot_off = std::fmax(foot_off, (standing_mahru::pose_left_foot(ground.robot) - foot).norm());
  }
  ground.acceleration(q, v);

  Figures figures;
  figures.bounded("the centre of mass is off its target by", (standing_mahru::center_of_mass(ground.robot) - target).norm(),
                  1e-4, "m");
  figures.bounded("the left foot has moved by at most", foot_off, 1e-5, "m");
  figures.bounded("the feet's weight is off the robot's by", std::abs(ground.forces[2] + ground.forces[8] - weight) / weight,
                  1e-6, "");
  figures.bounded("a foot that pulls at the ground does so by", std::fmax(0, -least), 1e-9, "N");
  figures.bounded("the feet's forces are not what the controller takes for them by", difference, 1e-6, "N");
  Eigen::Matrix<double, joints, 1> torques;
  figures.timed("one tick of the controller", [&] { torques = controller.torques(q, v, target); });
  return figures.exit_status();
}
