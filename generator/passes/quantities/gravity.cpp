// g_i = −J_i·[m γ; h × γ], with γ and the subtree's first moment h along the body's own axes.
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

void describe_gravity(Builder& b, int array) {
  if (b.scene().gravity_kind == ir::GravityKind::none) return;  // a new workspace has it: zero
  b.result({array, ir::Layout::per_coordinate, gravity_torques(b).torque});
}

}  // namespace dalembert::passes
