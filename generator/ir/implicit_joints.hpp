// Joints whose dampers and springs a linearly implicit step takes at its end (dalembert/integrators/linearly_implicit.hpp):
//
//   (M + h D + h² K) v̇ = τ − (C v + g) − D v − K (q − rest) − h K v
//
// D and K are diagonal, an elastic joint's spring having a coordinate of its own. So the left side is M with more armature, and
// the right that of forward dynamics with other forces: two numbers a joint, which depend on the step alone.
#pragma once

#include <vector>

#include "ir/kinematic_tree.hpp"

namespace dalembert::ir {

struct ImplicitJoint {
  int body = 0, coordinate = 0;       // in v
  double damping = 0, stiffness = 0;  // N m s/rad and N m/rad, or N s/m and N/m; a mimic driver's with those that it drives
};

// Components of inputs of kind `implicit`, whose index is the joint's place in the list.
inline constexpr int implicit_inertia = 0, implicit_force = 1, implicit_numbers = 2;  // h (D + h K); h K, times v

// Joints that have either, in the tree's order.
std::vector<ImplicitJoint> implicit_joints(const KinematicTree& tree);

}  // namespace dalembert::ir
