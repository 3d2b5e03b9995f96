// What plant, reference and law say to each other. Joints are in dalembert's order (mahru_fixed::joint_names) throughout.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace controller {

inline constexpr int joints = 25;
inline constexpr double period = 1e-3;  // s, one tick

using VectorJ = Eigen::Matrix<double, joints, 1>;

enum class Base { fixed, floating };

// The state as sensors would give it. The base is the pelvis; on the stand it stays where it is.
struct State {
  VectorJ q = VectorJ::Zero();                                        // rad
  VectorJ v = VectorJ::Zero();                                        // rad/s
  Eigen::Vector3d base_position = Eigen::Vector3d::Zero();            // m, world axes
  Eigen::Quaterniond base_rotation = Eigen::Quaterniond::Identity();  // base axes → world axes
  Eigen::Vector3d base_linear = Eigen::Vector3d::Zero();              // m/s, base axes
  Eigen::Vector3d base_angular = Eigen::Vector3d::Zero();             // rad/s, base axes
};

// Where the joints should be, with two derivatives.
struct Target {
  VectorJ q, v, a;
};

}  // namespace controller
