// M a + C v + g by recursive Newton-Euler, with the scene's armature, damping, friction and springs.
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

void describe_inverse_dynamics(Builder& b, int array) {
  b.result({array, ir::Layout::per_coordinate, newton_euler(b, Driven::accelerated).torque});
}

}  // namespace dalembert::passes
