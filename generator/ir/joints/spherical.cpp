// A ball: a unit quaternion x y z w, the child's axes in the parent's, and the child's angular velocity along its own axes. Its
// parts turn about these.
#include "ir/robot_description.hpp"

namespace dalembert::ir {

namespace {
std::vector<JointPart> spherical_parts(const Joint&) {
  return {turning("x", Eigen::Vector3d::UnitX()), turning("y", Eigen::Vector3d::UnitY()),
          turning("z", Eigen::Vector3d::UnitZ())};
}
}  // namespace

JointTypeRow joints::spherical() {
  return {.word = "spherical",
          .coordinates = "quaternion x y z w; angular velocity along the child's axes [rad/s]",
          .nq = 4,
          .nv = 3,
          .quaternion = 0,
          .turns = true,
          .slides = false,
          .has_axis = false,
          .in_urdf = false,
          .in_scenes = true,
          .parts = spherical_parts};
}

}  // namespace dalembert::ir
