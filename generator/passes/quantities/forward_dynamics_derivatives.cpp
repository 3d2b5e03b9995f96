// dv̇/dq = −M⁻¹ dτ/dq and dv̇/dv = −M⁻¹ dτ/dv at the v̇ of forward dynamics (Carpentier and Mansard 2018).
#include <algorithm>

#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

namespace {

// first: the efforts do not depend on the coordinates before this one.
void solve(Builder& b, int array, const std::string& name, void (*of_efforts)(Builder&, int), int first) {
  const int nv = b.tree().nv(), efforts = b.internal_array(b.own_name(name), nv, nv);
  of_efforts(b, efforts);
  const auto inverted = [&] {
    return std::find_if(b.steps().begin(), b.steps().end(),
                        [](const ir::MatrixStep& step) { return step.kind == ir::MatrixStep::Kind::invert; });
  };
  if (inverted() == b.steps().end()) inverse_mass_matrix(b);
  b.step({ir::MatrixStep::Kind::negative_product, inverted()->room, efforts, array, -1, first});
  guard(b, array);
}

}  // namespace

void describe_forward_dynamics_dq(Builder& b, int array) {
  const int position = b.floating() ? 3 : 0;  // the base's: nothing depends on it
  solve(b, array, "efforts_dq", describe_inverse_dynamics_dq, position);
}
void describe_forward_dynamics_dv(Builder& b, int array) { solve(b, array, "efforts_dv", describe_inverse_dynamics_dv, 0); }

}  // namespace dalembert::passes
