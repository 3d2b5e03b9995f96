// Rotation matrices whose zeros and ones are exact, so that axis-aligned robots keep their structure.
#pragma once

#include <Eigen/Core>

namespace dalembert::ir {

// Rz(yaw) Ry(pitch) Rx(roll): URDF's rpy. Zero angles leave exact zeros and ones; nothing is snapped.
Eigen::Matrix3d rotation_from_rpy(const Eigen::Vector3d& rpy);

// Rotation by `angle` (rad) about a unit axis. About ±x, ±y, ±z it equals rotation_from_rpy bit for bit; by zero it is the
// identity.
Eigen::Matrix3d rotation_about(const Eigen::Vector3d& axis, double angle);

// The rotation with entries within rounding of 0, 1 and −1 made exact. π/2 is no double, and its cosine is
// 6e-17 rather than zero: a turn that was meant to be square becomes so.
Eigen::Matrix3d without_rounding_dust(Eigen::Matrix3d rotation);

// R I Rᵀ, symmetric to the last bit: a rotational inertia of one frame in the axes of another. An identity changes no bit.
Eigen::Matrix3d rotated(const Eigen::Matrix3d& inertia, const Eigen::Matrix3d& rotation);

}  // namespace dalembert::ir
