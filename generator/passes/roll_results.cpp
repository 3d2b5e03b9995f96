#include <algorithm>
#include <set>
#include <tuple>

#include "passes/roll_state.hpp"

namespace dalembert::passes {

void roll_results(RollState& state) {
  const ir::KinematicTree& tree = state.tree;
  // A coordinate may have a part of two results: of a loop's two links, where one follows a joint above the other.
  std::set<std::tuple<int, int, int>> set;  // array, row or column, first element of it
  for (std::size_t n = 0; n < state.algorithm.results.size(); ++n) {
    const ir::Result& r = state.algorithm.results[n];
    if (r.layout == ir::Layout::base) continue;
    const ir::OutputArray& array = state.array(r.array);
    const bool columns = r.layout == ir::Layout::columns, driven = tree.independent_joints() < tree.joints();
    ir::JointResult result{static_cast<int>(n), r.over.is_all() && !driven && !tree.within && !array.is_part(), {}};
    for (int k = 0; k < tree.joints(); ++k) {
      if (!state.asked(r.array, !columns, k) || !r.over.contains(tree, k)) continue;
      const int of_whole = tree.base_coordinates() + state.coordinates[static_cast<std::size_t>(k)],
                row = columns ? array.column(of_whole) : array.row(of_whole);
      const bool first = set.insert({r.array, row, columns ? r.from : 0}).second;
      for (int i = 0; i < state.role(r.role).components(); ++i)
        result.elements.push_back({columns ? array.rows * row + r.from + i : row, {r.role, i, k}, first});
    }
    state.program.results.push_back(std::move(result));
  }
}

namespace {

// The array of joints' axes that constraints bear along; −1: none do.
int axes_of_wrenches(const ir::Algorithm& algorithm) {
  int array = -1;
  for (const ir::Kernel& kernel : algorithm.kernels)
    if (kernel.by_wrenches()) array = kernel[ir::Operand::axes];
  return array;
}

std::optional<ir::PivotRoles> pivots_in_slots(const RollState& state) {
  const std::optional<ir::Guard>& guard = state.algorithm.guard;
  const std::vector<ir::Kernel>& kernels = state.algorithm.kernels;
  const bool by_limbs = std::any_of(kernels.begin(), kernels.end(), [](const ir::Kernel& k) { return k.by_limbs(); });
  const bool others =
      std::any_of(kernels.begin(), kernels.end(), [](const ir::Kernel& k) { return !k.by_limbs() && !k.by_wrenches(); });
  if (!guard || others) return {};
  ir::PivotRoles roles;
  for (const ir::Result& r : state.algorithm.results) {
    if (r.array == guard->pivots) roles.pivot = r.role;
    if (r.array == guard->diagonal) roles.diagonal = r.role;
    if (r.array == guard->gain) roles.gain = r.role;
    if (r.array == guard->joint) (r.from == 0 ? roles.linear : roles.angular) = r.role;
  }
  // Rows go up limbs by all of them.
  for (const int role : {roles.gain, roles.linear, roles.angular})
    if (by_limbs && (role < 0 || !state.program.is_kept(role))) return {};
  return roles;
}

std::optional<ir::AxesRoles> axes_in_slots(const RollState& state) {
  const int array = axes_of_wrenches(state.algorithm);
  ir::AxesRoles roles;
  for (const ir::Result& r : state.algorithm.results)
    if (r.array == array) (r.from == 0 ? roles.linear : roles.angular) = r.role;
  if (roles.linear < 0 || !state.program.is_kept(roles.linear) || !state.program.is_kept(roles.angular)) return {};
  return roles;
}

}  // namespace

void leave_in_slots(RollState& state) {
  ir::RolledProgram& program = state.program;
  program.pivots_in_slots = pivots_in_slots(state);
  program.axes_in_slots = axes_in_slots(state);
  std::set<int> roles;
  if (const std::optional<ir::PivotRoles>& p = program.pivots_in_slots)
    roles = {p->pivot, p->diagonal, p->gain, p->linear, p->angular};
  const int axes = program.axes_in_slots ? axes_of_wrenches(state.algorithm) : -1;
  for (ir::JointResult& joints : program.results) {
    const ir::Result& r = state.algorithm.results[static_cast<std::size_t>(joints.result)];
    joints.copied = !roles.contains(r.role) && r.array != axes;
  }
  for (ir::BaseStage& stage : program.base)
    stage.checks_pivots =
        program.pivots_in_slots && std::any_of(stage.elements.begin(), stage.elements.end(),
                                               [&](const auto& e) { return e.array == state.algorithm.guard->pivots; });
}

}  // namespace dalembert::passes
