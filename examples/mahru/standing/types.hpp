// What plan, law and plant say to each other. Forces and moments of a foot are those of the ground on the robot, about the
// middle of the sole, along the sole's axes: x forward, y left, z up through the foot.
#pragma once

#include <array>

#include "../controller/types.hpp"

namespace standing {

using controller::joints, controller::period, controller::State, controller::VectorJ;
using Eigen::Vector3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Vector12 = Eigen::Matrix<double, 12, 1>;

enum Side { left, right };
inline constexpr std::array<Side, 2> sides{left, right};
inline constexpr Side other(Side side) { return side == left ? right : left; }

// The sole of MAHRU's feet (mahru.urdf): its middle in the link's frame, and half its size.
inline Vector3d sole_in_foot(Side side) { return {0.03, side == left ? 0.01 : -0.01, -0.10}; }
inline constexpr double sole_x = 0.12, sole_y = 0.06;  // m

// What a foot is to do.
struct FootTarget {
  double load = 1;  // how much it may bear, as a share of the robot's weight and half of it again; 0: it is in the air
  Vector3d p = Vector3d::Zero(), v = Vector3d::Zero(), a = Vector3d::Zero();  // of the sole's middle: m, m/s, m/s², world
};

// What the robot is to do. Feet stay level and point ahead, the pelvis upright, the arms in their posture.
struct Target {
  Vector3d com = Vector3d::Zero(), com_v = Vector3d::Zero(), com_a = Vector3d::Zero();  // centre of mass: m, m/s, m/s², world
  std::array<FootTarget, 2> foot;
  Vector3d push = Vector3d::Zero();  // N, at the torso's centre of mass, world axes: for the plant alone, the law does not know
};

}  // namespace standing
