// dv̇/dq = −M⁻¹ dτ/dq and dv̇/dv = −M⁻¹ dτ/dv at the v̇ of forward dynamics (Carpentier and Mansard 2018).
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

namespace {

void solve(Builder& b, int array, const std::string& name, void (*of_efforts)(Builder&, int)) {
  const int nv = b.tree().nv(), efforts = b.internal_array(b.own_name(name), nv, nv);
  of_efforts(b, efforts);
  int inverse = -1;
  for (const ir::MatrixStep& step : b.steps())
    if (step.kind == ir::MatrixStep::Kind::invert) inverse = step.to;
  if (inverse < 0) inverse = inverse_mass_matrix(b);
  b.step({ir::MatrixStep::Kind::negative_product, inverse, efforts, array, -1});
  guard(b, array);
}

}  // namespace

void describe_forward_dynamics_dq(Builder& b, int array) { solve(b, array, "efforts_dq", describe_inverse_dynamics_dq); }
void describe_forward_dynamics_dv(Builder& b, int array) { solve(b, array, "efforts_dv", describe_inverse_dynamics_dv); }

}  // namespace dalembert::passes
