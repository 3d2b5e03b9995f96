// One displacement along the axis.
#include "ir/robot_description.hpp"

namespace dalembert::ir {

namespace {
std::vector<JointPart> prismatic_parts(const Joint& joint) { return {{"", joint.type, joint.axis}}; }
}  // namespace

JointPart sliding(const char* suffix, const Eigen::Vector3d& axis) { return {suffix, JointType::prismatic, axis}; }

JointTypeRow joints::prismatic() {
  return {.word = "prismatic",
          .coordinates = "displacement [m]",
          .nq = 1,
          .nv = 1,
          .quaternion = -1,
          .turns = false,
          .slides = true,
          .has_axis = true,
          .in_urdf = true,
          .in_scenes = false,
          .parts = prismatic_parts};
}

}  // namespace dalembert::ir
