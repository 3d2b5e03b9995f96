// A screw: one angle about the axis, along which it slides by its pitch per turn.
#include "passes/joints/kinds.hpp"

namespace dalembert::passes {

namespace {
std::vector<JointPart> helical_parts(const ir::Joint& joint) { return {{"", joint.type, joint.axis}}; }
}  // namespace

JointKindRow helical() { return {"helical", "angle [rad]", 1, 1, helical_parts}; }

}  // namespace dalembert::passes
