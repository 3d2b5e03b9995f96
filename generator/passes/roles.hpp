// The values that the rolled form keeps per slot between paragraphs.
#pragma once

#include <vector>

#include "ir/rolled.hpp"
#include "passes/equations.hpp"

namespace dalembert::passes {

// Values kept per slot.
enum RoleId : int {
  sine,
  cosine,
  slide,
  rate,  // of the joint
  pose_sine,
  pose_cosine,
  pose_slide,  // the same for the poses of Phase I: at rest where the joint carries the reference frame
  rotation,    // R, column by column; its third column is the joint's axis
  position,
  joint_linear,
  joint_angular,
  joint_rate,
  velocity,
  first,
  second,
  momentum,
  bias_block,
  inertia_force,
  bias_force,
  transposed,
  below_force,
  down,
  gravity_first,
  gravity_torque,
  motion,
  force,
  bias_torque,
  role_count
};

// Names and meanings, by RoleId.
std::vector<ir::Role> make_roles();

// Whether attached limbs add to the role: a sum over the subtree.
bool is_sum(int role);

// Lets the forces take the place of poses and velocities, which nobody reads once their own segment runs inwards.
void share_places(ir::RolledProgram& program);

// Calls put(role, component, value) for every component of Phase II's sums.
template <class Put>
void each_sum(const Sums& s, const Put& put) {
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    put(first, i, s.first[at]);
    put(momentum, i, s.momentum[at]);
    for (int j = 0; j < 3; ++j) put(bias_block, 3 * i + j, s.bias[at][static_cast<std::size_t>(j)]);
  }
  for (int i = 0; i < 6; ++i) put(second, i, s.second[static_cast<std::size_t>(i)]);
}

}  // namespace dalembert::passes
