// v̇ = M⁻¹ (τ − C v − g), by articulated bodies.
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

void describe_forward_dynamics(Builder& b, int array) {
  b.result({array, ir::Layout::per_coordinate, solved_accelerations(b).acceleration});
  guard(b, array);
}

}  // namespace dalembert::passes
