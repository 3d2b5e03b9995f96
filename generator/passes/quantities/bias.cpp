// C v + g by recursive Newton-Euler, with the scene's damping, friction and springs.
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

void describe_bias(Builder& b, int array) {
  if (bias_is_gravity(b)) return describe_gravity(b, array);
  b.result({array, ir::Layout::per_coordinate, newton_euler(b, Driven::at_rest).torque});
}

}  // namespace dalembert::passes
