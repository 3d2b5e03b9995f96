// Lowers a tree to paragraphs over slots: the rolled form.
#pragma once

#include "ir/kinematic_tree.hpp"
#include "ir/normal_tree.hpp"
#include "ir/plan.hpp"
#include "ir/rolled.hpp"
#include "ir/scene.hpp"

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
  body_linear,
  body_angular,
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

ir::RolledProgram lower_rolled(const ir::KinematicTree& tree, const ir::NormalTree& normal, const ir::Scene& scene,
                               const ir::Plan& plan, const ir::Graph::Options& options);

}  // namespace dalembert::passes
