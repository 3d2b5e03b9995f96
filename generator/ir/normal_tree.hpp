// The tree in the frames and parameters the equations are cheapest in; made by passes/normalise.
//
// Every joint's axis is the z axis of its body's frame. A body's inertia is given by moments about the frame's origin, as many
// as possible of them moved to the parent: what lies on a revolute joint's axis moves with either body.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace dalembert::ir {

// Moments of the mass distribution about a frame's origin, in the frame's axes. Moments of bodies joined rigidly add, but for
// `half_trace`, which belongs to one body's own rotation and enters the Coriolis matrix alone.
struct Moments {
  double mass = 0;                                   // Σ m, kg
  Eigen::Vector3d first = Eigen::Vector3d::Zero();   // Σ m x, kg m
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  // Σ m x xᵀ, kg m²; rotational inertia = tr(second)·1 − second
  double half_trace = 0;                             // ½ tr of the body's inertia about its own centre of mass, kg m²
};

struct NormalBody {
  int parent = -1;                                         // −1: the base
  double turning = 1, sliding = 0;                         // per unit of the coordinate, about z and along it: rad, m
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  // this frame in the parent's frame at q = 0
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Moments moments;                                              // after moving
  Moments own;                                                  // before moving: the body as it is
  Moments moved;                                                // of these, and of what children gave, what the parent got
  Eigen::Matrix3d link_rotation = Eigen::Matrix3d::Identity();  // the URDF link's axes in this frame
  Eigen::Vector3d link_translation = Eigen::Vector3d::Zero();   // the URDF link's origin in this frame
};

struct NormalTree {
  Moments base;  // with everything that moved down to it
  std::vector<NormalBody> bodies;
};

}  // namespace dalembert::ir
