// A screw: one angle about the axis, along which it slides by its pitch per turn.
#include "ir/robot_description.hpp"

namespace dalembert::ir {

namespace {
std::vector<JointPart> helical_parts(const Joint& joint) { return {{"", joint.type, joint.axis}}; }
}  // namespace

JointTypeRow joints::helical() {
  return {.word = "helical",
          .coordinates = "angle [rad]",
          .nq = 1,
          .nv = 1,
          .quaternion = -1,
          .turns = true,
          .slides = true,
          .has_axis = true,
          .in_urdf = false,
          .in_scenes = true,
          .parts = helical_parts};
}

}  // namespace dalembert::ir
