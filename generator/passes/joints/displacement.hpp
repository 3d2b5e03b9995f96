// Where a joint takes its child, and what of the child's mass that leaves as it is.
#pragma once

#include <Eigen/Geometry>

#include "ir/normal_tree.hpp"
#include "ir/robot_description.hpp"

namespace dalembert::passes {

// The joint as a scene says.
ir::Joint with_kind(ir::Joint joint, const ir::JointKind& kind);

// Where the child stands, in its frame at zero, when a joint of one coordinate is at `position` (rad or m).
Eigen::Isometry3d displacement(const ir::Joint& joint, double position);

// The part of a body's moments that the parent can carry as well, in the frame whose z the body turns about or slides along;
// taken out of `moments`.
ir::Moments take_movable(ir::Moments& moments, bool turns, bool slides);

}  // namespace dalembert::passes
