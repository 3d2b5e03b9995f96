// One displacement along the axis.
#include "passes/joints/kinds.hpp"

namespace dalembert::passes {

namespace {
std::vector<JointPart> prismatic_parts(const ir::Joint& joint) { return {{"", joint.type, joint.axis}}; }
}  // namespace

JointKindRow prismatic() { return {"prismatic", "displacement [m]", 1, 1, prismatic_parts}; }

}  // namespace dalembert::passes
