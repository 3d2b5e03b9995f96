#include "passes/joints/displacement.hpp"

#include <utility>

#include "ir/rotation.hpp"

namespace dalembert::passes {

ir::Joint with_kind(ir::Joint joint, const ir::JointKind& kind) {
  joint.type = kind.type;
  joint.pitch = kind.pitch;
  joint.second = kind.second;
  return joint;
}

Eigen::Isometry3d displacement(const ir::Joint& joint, double position) {
  Eigen::Isometry3d moved = Eigen::Isometry3d::Identity();
  for (const ir::JointPart& part : ir::row_of(joint.type).parts(joint)) {
    if (ir::slides(part.type)) moved.translation() = part.axis * position * ir::slide_per_unit(part.type, joint.pitch);
    if (ir::turns(part.type)) moved.linear() = ir::rotation_about(part.axis, position);
  }
  return moved;
}

// Moments of what does not change with the joint's position. A turn leaves what lies on the axis where it is, a slide the
// relative orientation; a screw the one moment that both leave.
ir::Moments take_movable(ir::Moments& moments, bool turns, bool slides) {
  ir::Moments moved;
  if (!turns) {  // the whole second moment and the trace; mass and first moment stay
    std::swap(moved.second, moments.second);
    std::swap(moved.half_trace, moments.half_trace);
    return moved;
  }
  std::swap(moved.second(2, 2), moments.second(2, 2));
  if (slides) return moved;
  std::swap(moved.mass, moments.mass);
  std::swap(moved.first.z(), moments.first.z());
  return moved;
}

}  // namespace dalembert::passes
