// URDF's floating joint: position in the parent's axes and unit quaternion x y z w; the child's linear and angular velocity
// along its own axes. The floating base's joint to the world, anywhere in the tree.
#include "passes/joints/kinds.hpp"

namespace dalembert::passes {

namespace {
std::vector<JointPart> free_flyer_parts(const ir::Joint&) {
  return {
      {"x", ir::JointType::prismatic, Eigen::Vector3d::UnitX()},   {"y", ir::JointType::prismatic, Eigen::Vector3d::UnitY()},
      {"z", ir::JointType::prismatic, Eigen::Vector3d::UnitZ()},   {"rx", ir::JointType::continuous, Eigen::Vector3d::UnitX()},
      {"ry", ir::JointType::continuous, Eigen::Vector3d::UnitY()}, {"rz", ir::JointType::continuous, Eigen::Vector3d::UnitZ()}};
}
}  // namespace

JointKindRow free_flyer() {
  return {"floating",
          "position [m] along the parent's axes, quaternion x y z w; linear and angular velocity along the child's axes [m/s, "
          "rad/s]",
          7, 6, free_flyer_parts};
}

}  // namespace dalembert::passes
