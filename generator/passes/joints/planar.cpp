// Two displacements in a plane and an angle about its normal. Where the normal is z the directions are x and y, as Pinocchio
// and DART have it, which do not read the axis; elsewhere those to which the shortest turn from z to the normal takes x and y,
// as MuJoCo does.
#include "passes/joints/kinds.hpp"

namespace dalembert::passes {

namespace {
std::vector<JointPart> planar_parts(const ir::Joint& joint) {
  const Eigen::Vector3d& n = joint.axis;
  Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY();
  if (n.z() > -1 + 1e-9) {
    x -= n.x() / (1 + n.z()) * (n + Eigen::Vector3d::UnitZ());
    y -= n.y() / (1 + n.z()) * (n + Eigen::Vector3d::UnitZ());
  } else {
    y = -y;  // of all half turns that about x
  }
  return {{"x", ir::JointType::prismatic, x.normalized()},
          {"y", ir::JointType::prismatic, y.normalized()},
          {"rz", ir::JointType::continuous, n}};
}
}  // namespace

JointKindRow planar() {
  return {"planar", "displacements along x and y [m], angle about the normal [rad]", 3, 3, planar_parts};
}

}  // namespace dalembert::passes
