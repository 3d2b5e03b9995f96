// One angle about the axis, between limits or without.
#include "ir/robot_description.hpp"

namespace dalembert::ir {

namespace {
std::vector<JointPart> revolute_parts(const Joint& joint) { return {{"", joint.type, joint.axis}}; }
}  // namespace

JointPart turning(const char* suffix, const Eigen::Vector3d& axis) { return {suffix, JointType::continuous, axis}; }

JointTypeRow joints::revolute() {
  return {.word = "revolute",
          .coordinates = "angle [rad]",
          .nq = 1,
          .nv = 1,
          .quaternion = -1,
          .turns = true,
          .slides = false,
          .has_axis = true,
          .in_urdf = true,
          .in_scenes = false,
          .parts = revolute_parts};
}

JointTypeRow joints::continuous() {
  JointTypeRow row = revolute();
  row.word = "continuous";
  return row;
}

}  // namespace dalembert::ir
