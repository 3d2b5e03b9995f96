#include "ir/rotation.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace dalembert::ir {

Eigen::Matrix3d rotation_from_rpy(const Eigen::Vector3d& rpy) {
  const double cr = std::cos(rpy.x()), sr = std::sin(rpy.x());
  const double cp = std::cos(rpy.y()), sp = std::sin(rpy.y());
  const double cy = std::cos(rpy.z()), sy = std::sin(rpy.z());
  Eigen::Matrix3d rotation;
  rotation << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,          //
      -sp, cp * sr, cp * cr;
  return rotation.array() + 0.0;  // no negative zeros
}

Eigen::Matrix3d rotation_about(const Eigen::Vector3d& axis, double angle) {
  if (angle == 0) return Eigen::Matrix3d::Identity();
  for (int i = 0; i < 3; ++i)
    if (std::abs(axis[i]) == 1 && axis.cwiseAbs().sum() == 1) return rotation_from_rpy(axis * angle);
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

Eigen::Matrix3d without_rounding_dust(Eigen::Matrix3d rotation) {
  constexpr double dust = 2.3e-16;
  for (double& entry : rotation.reshaped()) {
    if (std::abs(entry) < dust) entry = 0;
    if (std::abs(entry - 1) < dust) entry = 1;
    if (std::abs(entry + 1) < dust) entry = -1;
  }
  return rotation;
}

Eigen::Matrix3d rotated(const Eigen::Matrix3d& inertia, const Eigen::Matrix3d& rotation) {
  const Eigen::Matrix3d product = rotation * inertia * rotation.transpose();
  return 0.5 * (product + product.transpose());
}

}  // namespace dalembert::ir
