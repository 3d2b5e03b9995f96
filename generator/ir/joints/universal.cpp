// Two angles: about the axis, which is the parent's, and about a second one, which is the child's; both through one point.
#include "ir/robot_description.hpp"

namespace dalembert::ir {

namespace {
std::vector<JointPart> universal_parts(const Joint& joint) { return {turning("1", joint.axis), turning("2", joint.second)}; }
}  // namespace

JointTypeRow joints::universal() {
  return {.word = "universal",
          .coordinates = "angles about its axes [rad]",
          .nq = 2,
          .nv = 2,
          .quaternion = -1,
          .turns = true,
          .slides = false,
          .has_axis = true,
          .in_urdf = false,
          .in_scenes = true,
          .parts = universal_parts};
}

}  // namespace dalembert::ir
