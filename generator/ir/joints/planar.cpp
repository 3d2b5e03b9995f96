// Two displacements in a plane and an angle about its normal. Where the normal is z the directions are x and y, as Pinocchio
// and DART have it, which do not read the axis; elsewhere those to which the shortest turn from z to the normal takes x and y,
// as MuJoCo does.
#include "ir/robot_description.hpp"

namespace dalembert::ir {

namespace {
std::vector<JointPart> planar_parts(const Joint& joint) {
  const Eigen::Vector3d& n = joint.axis;
  Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY();
  const double aside = n.head<2>().squaredNorm();
  if (n.z() < 0 && aside < 1e-20) {
    y = -y;  // of all half turns that about x
  } else {
    const Eigen::Vector3d sum(n.x(), n.y(), n.z() < 0 ? aside / (1 - n.z()) : 1 + n.z());  // of n and z, without cancellation
    x -= n.x() / sum.z() * sum;
    y -= n.y() / sum.z() * sum;
  }
  return {sliding("x", x.normalized()), sliding("y", y.normalized()), turning("rz", n)};
}
}  // namespace

JointTypeRow joints::planar() {
  return {.word = "planar",
          .coordinates = "displacements along x and y [m], angle about the normal [rad]",
          .nq = 3,
          .nv = 3,
          .quaternion = -1,
          .turns = true,
          .slides = true,
          .has_axis = true,
          .in_urdf = true,
          .in_scenes = true,
          .parts = planar_parts};
}

}  // namespace dalembert::ir
