// Two angles: about the axis, which is the parent's, and about a second one, which is the child's; both through one point.
#include "passes/joints/kinds.hpp"

namespace dalembert::passes {

namespace {
std::vector<JointPart> universal_parts(const ir::Joint& joint) {
  return {{"1", ir::JointType::continuous, joint.axis}, {"2", ir::JointType::continuous, joint.second}};
}
}  // namespace

JointKindRow universal() { return {"universal", "angles about its axes [rad]", 2, 2, universal_parts}; }

}  // namespace dalembert::passes
