// URDF's floating joint: position in the parent's axes and unit quaternion x y z w; the child's linear and angular velocity
// along its own axes. The base's joint to the world where it floats, anywhere in the tree.
#include "ir/robot_description.hpp"

namespace dalembert::ir {

namespace {
std::vector<JointPart> free_flyer_parts(const Joint&) {
  return {sliding("x", Eigen::Vector3d::UnitX()),  sliding("y", Eigen::Vector3d::UnitY()),
          sliding("z", Eigen::Vector3d::UnitZ()),  turning("rx", Eigen::Vector3d::UnitX()),
          turning("ry", Eigen::Vector3d::UnitY()), turning("rz", Eigen::Vector3d::UnitZ())};
}
}  // namespace

JointTypeRow joints::free_flyer() {
  return {.word = "floating",
          .coordinates =
              "position [m] along the parent's axes, quaternion x y z w; linear and angular velocity along the child's axes "
              "[m/s, rad/s]",
          .nq = 7,
          .nv = 6,
          .quaternion = 3,
          .turns = true,
          .slides = true,
          .has_axis = false,
          .in_urdf = true,
          .in_scenes = true,
          .parts = free_flyer_parts};
}

}  // namespace dalembert::ir
