// dv̇/dq = −M⁻¹ dτ/dq and dv̇/dv = −M⁻¹ dτ/dv at the v̇ of forward dynamics (Carpentier and Mansard 2018).
//
// Articulated bodies give v̇ in the sweeps. Where joints are driven by others M's factors give it, behind all sweeps: what
// depends on it is the second half of the function then, and takes v̇ as inverse dynamics does.
#include <algorithm>
#include <functional>

#include "dalembert/chain_shapes.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

int padded_inverse(Builder& b) {
  if (!b.function().first_half.empty())
    return b.array_of_first_half(b.function().called_name("padded_inverse"), inverse_size(b.tree().nv()), 1);
  const auto inverted = [&] {
    return std::find_if(b.steps().begin(), b.steps().end(),
                        [](const ir::MatrixStep& step) { return step.kind == ir::MatrixStep::Kind::invert; });
  };
  if (inverted() == b.steps().end()) inverse_mass_matrix(b);
  return inverted()->room;
}

namespace {

// What the second half needs of the first: M⁻¹ and v̇.
void prepare_second_half(Builder& b) {
  padded_inverse(b);
  if (b.function().computes(ir::Quantity::forward_dynamics)) return;
  const std::string name = b.own_name("accelerations");
  if (!b.has_array(name)) describe_forward_dynamics(b, b.internal_array(name, b.tree().nv(), 1));
}

// Of the base's coordinates from `first` on, what three of them do to the base's linear acceleration alone: it is u' + w
// x u less gravity that equations of motion know, along the base's axes. Nothing else changes.
void set_base_columns(Builder& b, int array, const std::string& name, int first, const std::string& equation,
                      const std::function<Vec3(SweepBuilder&)>& about, double sign) {
  SweepBuilder base = b.sweep_of_base(b.own_name(name), equation);
  const Vec3 axis = about(base);
  for (int j = 0; j < 3; ++j) {
    const auto next = static_cast<std::size_t>((j + 1) % 3), last = static_cast<std::size_t>((j + 2) % 3);
    const int role = b.role({b.own_name(name) + "_" + "xyz"[j], "dv", equation, "", ir::Shape::vector});
    Vec3 column = base.zero();  // axis x e_j
    column[next] = sign > 0 ? axis[last] : -axis[last];
    column[last] = sign > 0 ? -axis[next] : axis[next];
    base.store(role, column);
    b.result({array, ir::Layout::base, role, (first + j) * b.tree().nv()});
  }
}

// first: the efforts do not depend on the coordinates before this one, or what these do is known.
void solve(Builder& b, ir::Quantity quantity, int array, const std::string& name, void (*of_efforts)(Builder&, int),
           int first) {
  if (!b.function().leaves(quantity)) {
    const int nv = b.tree().nv(), efforts = b.internal_array(b.own_name(name), nv, nv);
    of_efforts(b, efforts);
    b.step({ir::MatrixStep::Kind::negative_product, padded_inverse(b), efforts, array, -1, first});
  } else {
    prepare_second_half(b);
  }
  guard(b, array);
}

}  // namespace

void describe_forward_dynamics_dq(Builder& b, int array) {
  constexpr ir::Quantity own = ir::Quantity::forward_dynamics_dq;
  if (b.base_coordinates() == 0) return solve(b, own, array, "efforts_dq", describe_inverse_dynamics_dq, 0);
  // Nothing depends on the base's position; gravity turns against it, wrenches along the world's axes do not turn with it.
  const bool in_world = std::any_of(b.scene().wrenches.begin(), b.scene().wrenches.end(),
                                    [](const ir::ExternalWrench& wrench) { return wrench.in_world; });
  solve(b, own, array, "efforts_dq", describe_inverse_dynamics_dq, in_world ? 3 : 6);
  if (in_world || b.function().leaves(own)) return;
  const auto gravity = [](SweepBuilder& base) { return base.gravity_in_base(); };
  set_base_columns(b, array, "base_turned", 3, "gravity x e_j along the base's axes", gravity, 1);
}

void describe_forward_dynamics_dv(Builder& b, int array) {
  constexpr ir::Quantity own = ir::Quantity::forward_dynamics_dv;
  solve(b, own, array, "efforts_dv", describe_inverse_dynamics_dv, b.base_coordinates() > 0 ? 3 : 0);
  if (b.base_coordinates() == 0 || b.function().leaves(own)) return;
  const auto spin = [](SweepBuilder& base) { return base.base_twist().angular; };
  set_base_columns(b, array, "base_moved", 0, "-w x e_j along the base's axes", spin, -1);
}

std::vector<ir::EmittedFunction> halves(const ir::EmittedFunction& function, const ir::KinematicTree& tree) {
  std::vector<ir::EmittedFunction> all{function};
  const auto add = [&](const std::string& name, const std::string& type, const std::vector<ir::Quantity>& quantities,
                       const std::string& accelerations) {
    ir::EmittedFunction later{function.own_name(name), function.type + type, ir::Function::inverse_dynamics, function.named};
    for (const ir::Quantity quantity : quantities)
      if (function.computes(quantity)) later.quantities.push_back(quantity);
    later.first_half = function.name;
    later.accelerations = all.back().hands_on = accelerations;
    all.back().second_half = later.name;
    all.front().later.insert(all.front().later.end(), later.quantities.begin(), later.quantities.end());
    all.push_back(std::move(later));
  };
  const auto own = [&](ir::Quantity quantity, const char* name) {
    return function.computes(quantity) ? function.result(quantity) : function.own_name(name);
  };
  // dv̇/dv alone does not depend on v̇.
  const bool all_own = tree.independent_joints() == tree.joints();
  if (!all_own && function.computes(ir::Quantity::forward_dynamics_dq))
    add("derivatives", "Derivatives", {ir::Quantity::forward_dynamics_dq, ir::Quantity::forward_dynamics_dv},
        own(ir::Quantity::forward_dynamics, "accelerations"));
  const std::vector<ir::Quantity> constrained{ir::Quantity::constrained_forward_dynamics_dq,
                                              ir::Quantity::constrained_forward_dynamics_dv, ir::Quantity::constraint_forces_dq,
                                              ir::Quantity::constraint_forces_dv};
  if (std::any_of(constrained.begin(), constrained.end(), [&](ir::Quantity q) { return function.computes(q); })) {
    add("constrained_derivatives", "ConstrainedDerivatives", constrained,
        own(ir::Quantity::constrained_forward_dynamics, "constrained_accelerations"));
    all.back().forces = own(ir::Quantity::constraint_forces, "forces");
  }
  return all;
}

}  // namespace dalembert::passes
