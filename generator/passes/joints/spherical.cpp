// A ball: a unit quaternion x y z w, the child's axes in the parent's, and the child's angular velocity along its own axes. Its
// parts turn about these.
#include "passes/joints/kinds.hpp"

namespace dalembert::passes {

namespace {
std::vector<JointPart> spherical_parts(const ir::Joint&) {
  return {{"x", ir::JointType::continuous, Eigen::Vector3d::UnitX()},
          {"y", ir::JointType::continuous, Eigen::Vector3d::UnitY()},
          {"z", ir::JointType::continuous, Eigen::Vector3d::UnitZ()}};
}
}  // namespace

JointKindRow spherical() {
  return {"spherical", "quaternion x y z w; angular velocity along the child's axes [rad/s]", 4, 3, spherical_parts};
}

}  // namespace dalembert::passes
