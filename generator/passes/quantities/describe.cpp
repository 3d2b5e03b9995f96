#include <algorithm>

#include "ir/identifier.hpp"
#include "passes/quantities/complete_guard.hpp"
#include "passes/quantities/quantities.hpp"

namespace dalembert::passes {
namespace {

void describe(Builder& b, ir::Quantity quantity) {
  const int array = b.output(quantity);
  switch (quantity) {
#define DALEMBERT_QUANTITY(name, ...) \
  case ir::Quantity::name:            \
    return describe_##name(b, array);
#include "ir/quantities.def"
#undef DALEMBERT_QUANTITY
  }
}

}  // namespace

// What a link is called among roles and sweeps, where contacts and loops have their members' names, and link_place() has one of
// its own: one that looks like these is set apart, for of two of one name the second would be taken for the first.
static std::string name_among_roles(const std::string& link) {
  const std::string name = ir::identifier(link);
  for (const char* taken : {"ground_", "contact_", "loop_", "own_"})
    if (name.starts_with(taken)) return "own_" + name;
  return name == "twist" ? "own_" + name : name;  // acceleration_twist is all bodies'
}

LinkFrame link_frame(const std::string& link, const ir::KinematicTree& tree, const ir::NormalTree& normal) {
  LinkFrame frame{name_among_roles(link)};
  for (const ir::LinkPlacement& at : tree.links) {
    if (at.link != link) continue;
    frame.body = at.body;
    frame.rotation = at.placement.linear();
    frame.translation = at.placement.translation();
  }
  if (frame.body < 0) return frame;
  const ir::NormalBody& n = normal.bodies[static_cast<std::size_t>(frame.body)];
  frame.translation = n.link_rotation * frame.translation + n.link_translation;
  frame.rotation = n.link_rotation * frame.rotation;
  return frame;
}

std::vector<ir::Solver> solvers(const ir::EmittedFunction& function, const ir::KinematicTree& tree, const ir::Scene& scene) {
  if (scene.forward_dynamics) return {*scene.forward_dynamics};
  if (tree.independent_joints() < tree.joints()) return {ir::Solver::factorization};
  const bool solves = std::any_of(function.quantities.begin(), function.quantities.end(),
                                  [](ir::Quantity q) { return ir::is_solved(ir::row_of(q).scale); });
  if (!solves) return {ir::Solver::articulated_bodies};
  return {ir::Solver::articulated_bodies, ir::Solver::factorization};
}

std::vector<ir::Algorithm> describe(const ir::EmittedFunction& function, const ir::KinematicTree& tree,
                                    const ir::NormalTree& normal, const ir::Scene& scene, const ir::Graph::Options& options) {
  return describe(function, tree, normal, scene, solvers(function, tree, scene).front(), options);
}

std::vector<ir::Algorithm> describe(const ir::EmittedFunction& function, const ir::KinematicTree& tree,
                                    const ir::NormalTree& normal, const ir::Scene& scene, ir::Solver solver,
                                    const ir::Graph::Options& options, Purpose purpose) {
  Builder b(function, tree, normal, scene, solver, options, purpose);
  // What is made before its turn, for what asks for it, stands in the order asked for all the same.
  for (const ir::Quantity quantity : function.quantities) b.output(quantity);
  for (const ir::Quantity quantity : function.quantities) describe(b, quantity);
  for (const ir::LinkOutput& output : function.of_links) {
    const ir::LinkQuantityRow& row = ir::row_of(output.quantity);
    const ir::Part* const part = output.part ? &*output.part : nullptr;
    const int array =
        b.array_of_part(function.result(output), ir::extent(row.rows, tree, part), ir::extent(row.columns, tree, part),
                        ir::map_of(part, row.rows, tree), ir::map_of(part, row.columns, tree));
    describe_link_quantity(b, link_frame(output.link, tree, normal), output.quantity, array);
  }
  complete_guard(b);
  return b.take();
}

}  // namespace dalembert::passes
