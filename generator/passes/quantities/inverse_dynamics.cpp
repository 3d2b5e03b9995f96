// M a + C v + g by recursive Newton-Euler, with the scene's armature, damping, friction and springs.
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

void describe_inverse_dynamics(Builder& b, int array) {
  const NewtonEuler all = newton_euler(b, Driven::accelerated);
  b.result({array, ir::Layout::per_coordinate, less_external(b, all.torque, all.subtree_wrench)});
}

}  // namespace dalembert::passes
