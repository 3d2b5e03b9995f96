// The kinds of joints, a file and a row each: what the compiler and its commands know of a type of joint stands there.
//
// A body of the tree has one coordinate (ir/kinematic_tree.hpp): its joint turns about an axis, slides along it, or both at a
// fixed rate. A joint of several coordinates is a row of such bodies, all but the last without mass (passes/build_tree), which
// keep the joint's name.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "ir/normal_tree.hpp"
#include "ir/robot_description.hpp"

namespace dalembert::passes {

// One of a joint's coordinates.
struct JointPart {
  std::string suffix;    // of its name, behind the joint's: "x"; empty where the joint has no other
  ir::JointType type;    // revolute, continuous, prismatic or helical
  Eigen::Vector3d axis;  // unit, in the frame of the child link
};

struct JointKindRow {
  const char* name;         // as URDF and scenes have it
  const char* coordinates;  // what they are, for the reader
  int nq, nv;               // numbers of q and of v
  // From the parent to the child: each moves all behind it.
  std::vector<JointPart> (*parts)(const ir::Joint& joint);
};

JointKindRow revolute();
JointKindRow continuous();
JointKindRow prismatic();
JointKindRow helical();
JointKindRow universal();
JointKindRow planar();
JointKindRow spherical();
JointKindRow free_flyer();

// Of every type but fixed.
JointKindRow kind_of(ir::JointType type);

// The joint as a scene says.
ir::Joint with_kind(ir::Joint joint, const ir::JointKind& kind);

// Where the child stands, in its frame at zero, when a joint of one coordinate is at `position` (rad or m).
Eigen::Isometry3d displacement(const ir::Joint& joint, double position);

// The part of a body's moments that the parent can carry as well, in the frame whose z the body turns about or slides along;
// taken out of `moments`.
ir::Moments take_movable(ir::Moments& moments, bool turns, bool slides);

}  // namespace dalembert::passes
