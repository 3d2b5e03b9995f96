// RobotDescription + Scene → KinematicTree: fixed and locked joints fused, cut subtrees removed, bodies in depth-first order.
//
// Children stand in urdfdom's order, alphabetical by joint name. A locked joint is treated exactly as a fixed joint at that
// value, so locking and fixing give the same tree to the last bit. Takes time in proportion to the links, without recursion.
#pragma once

#include "diagnostics.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/robot_description.hpp"
#include "ir/scene.hpp"

namespace dalembert::passes {

// The scene's names must be known to the robot (frontend/scene_check). Throws InputError when nothing is left to move, when the
// scene asks for something at a link that is welded to the ground, and when a number is too large to compute with
// (magnitudes.hpp). Warns where M is singular: of joints that move no mass, unless no joint moves any, and of a last body whose
// inertia about its joint's axis is zero, as a point mass on the axis has.
ir::KinematicTree build_tree(const ir::RobotDescription& robot, const ir::Scene& scene, Diagnostics& warnings);

}  // namespace dalembert::passes
