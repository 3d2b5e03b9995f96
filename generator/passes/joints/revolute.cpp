// One angle about the axis.
#include "passes/joints/kinds.hpp"

namespace dalembert::passes {

namespace {
std::vector<JointPart> revolute_parts(const ir::Joint& joint) { return {{"", joint.type, joint.axis}}; }
}  // namespace

JointKindRow revolute() { return {"revolute", "angle [rad]", 1, 1, revolute_parts}; }
JointKindRow continuous() { return {"continuous", "angle [rad]", 1, 1, revolute_parts}; }

}  // namespace dalembert::passes
