#include "passes/embedding.hpp"

#include <algorithm>

#include "dalembert/chain_shapes.hpp"
#include "ir/coordinate_tree.hpp"

namespace dalembert::passes {
namespace {

using Kind = ir::Projected::Kind;
using ir::LinkQuantity;
using ir::Quantity;

class Embed {
 public:
  Embed(const ir::EmittedFunction& function, const ir::KinematicTree& tree, const ir::Scene& scene)
      : function_(function), tree_(tree), opened_(tree.opened()), scene_(scene) {
    algorithm_.function = function;
    algorithm_.section = {0, function.name, function.type, function.inputs, function.quantities};
    own_.name = function.name + "_of_all_joints";
    own_.type = function.type + "OfAllJoints";
    own_.named = true;
  }

  EmbeddedFunction run() {
    for (const Quantity quantity : function_.quantities) output(quantity);
    for (const ir::LinkOutput& link : function_.of_links) {
      const ir::LinkQuantityRow& row = ir::row_of(link.quantity);
      array(function_.result(link), ir::extent(row.rows, tree_), ir::extent(row.columns, tree_), false);
    }
    for (const Quantity quantity : function_.quantities) describe(quantity);
    for (const ir::LinkOutput& link : function_.of_links) describe(link);
    finish();
    return {std::move(algorithm_), std::move(own_)};
  }

 private:
  int array(const std::string& name, int rows, int columns, bool internal) {
    for (size_t i = 0; i < algorithm_.arrays.size(); ++i)
      if (algorithm_.arrays[i].name == name) return static_cast<int>(i);
    algorithm_.arrays.push_back({name, rows, columns, internal});
    return static_cast<int>(algorithm_.arrays.size()) - 1;
  }
  int room(const std::string& name, int rows, int columns) { return array(function_.own_name(name), rows, columns, true); }
  int output(Quantity quantity) {
    const ir::QuantityRow& row = ir::row_of(quantity);
    return array(function_.result(quantity), ir::extent(row.rows, tree_), ir::extent(row.columns, tree_), false);
  }

  // What the other function is to compute; its array.
  std::string whole(Quantity quantity) {
    if (!own_.computes(quantity)) own_.quantities.push_back(quantity);
    if (ir::row_of(quantity).function != ir::Function::evaluate) own_.inputs = ir::Function::inverse_dynamics;
    return own_.result(quantity);
  }
  std::string whole(const ir::LinkOutput& link) {
    if (std::find(own_.of_links.begin(), own_.of_links.end(), link) == own_.of_links.end()) own_.of_links.push_back(link);
    return own_.result(link);
  }

  void project(Kind kind, Quantity from, int to, const std::string& more = "") {
    const ir::QuantityRow& row = ir::row_of(from);
    ir::Projected p{kind, whole(from), more, ir::extent(row.rows, opened_), ir::extent(row.columns, opened_), to};
    if (kind == Kind::rows_of_turned) p.room = room("forces_of_all_joints", opened_.nv(), 1);
    algorithm_embedding().projected.push_back(std::move(p));
  }

  ir::Embedding& algorithm_embedding() {
    if (!algorithm_.embedding) algorithm_.embedding.emplace();
    return *algorithm_.embedding;
  }

  void describe(Quantity quantity) {
    const int to = output(quantity);
    switch (quantity) {
      case Quantity::mass_matrix: mass(); return;
      case Quantity::coriolis_matrix: return project(Kind::both_turned, quantity, to, whole(Quantity::mass_matrix));
      case Quantity::bias:
        if (scene_.rates_zero) return project(Kind::rows, quantity, to);
        return project(Kind::rows_of_turned, quantity, to, whole(Quantity::mass_matrix));
      case Quantity::gravity:
      case Quantity::wrench_influence:
      case Quantity::inverse_dynamics:
      case Quantity::regressor: return project(Kind::rows, quantity, to);
      case Quantity::center_of_mass_jacobian:
      case Quantity::momentum_matrix: return project(Kind::columns, quantity, to);
      case Quantity::center_of_mass_bias: return project(Kind::turned, quantity, to, whole(Quantity::center_of_mass_jacobian));
      case Quantity::momentum_bias: return project(Kind::turned, quantity, to, whole(Quantity::momentum_matrix));
      case Quantity::mass_matrix_factor:
        factor();
        guard(to);
        algorithm_.factor = to;
        return;
      case Quantity::inverse_mass_matrix: {
        const int upper = factor(), padded = room("padded_inverse", inverse_size(tree_.nv()), 1);
        algorithm_.kernels.push_back(ir::Kernel(ir::Kernel::Kind::invert, {{ir::Operand::factor, upper},
                                                                           {ir::Operand::pivots, algorithm_.guard->pivots},
                                                                           {ir::Operand::inverse, padded},
                                                                           {ir::Operand::to, to}}));
        return guard(to);
      }
      case Quantity::forward_dynamics:
        project(Kind::unbalanced, Quantity::inverse_dynamics, to);
        algorithm_.kernels.push_back(
            ir::Kernel(ir::Kernel::Kind::solve, {{ir::Operand::factor, factor()}, {ir::Operand::to, to}}));
        return guard(to);
      default: return project(Kind::same, quantity, to);  // others are refused (ir::is_of_linkages)
    }
  }

  void describe(const ir::LinkOutput& link) {
    const ir::LinkQuantityRow& row = ir::row_of(link.quantity);
    ir::Projected p{Kind::same,
                    whole(link),
                    "",
                    ir::extent(row.rows, opened_),
                    ir::extent(row.columns, opened_),
                    array(function_.result(link), ir::extent(row.rows, tree_), ir::extent(row.columns, tree_), false)};
    const auto bias_by = [&](LinkQuantity jacobian) {
      p.kind = Kind::turned;
      p.more = whole(ir::LinkOutput{jacobian, link.link});
    };
    switch (link.quantity) {
      case LinkQuantity::pose:
      case LinkQuantity::twist: break;
      case LinkQuantity::jacobian:
      case LinkQuantity::jacobian_world:
      case LinkQuantity::jacobian_mixed: p.kind = Kind::columns; break;
      case LinkQuantity::acceleration_bias: bias_by(LinkQuantity::jacobian); break;
      case LinkQuantity::acceleration_bias_world: bias_by(LinkQuantity::jacobian_world); break;
      case LinkQuantity::acceleration_bias_mixed: bias_by(LinkQuantity::jacobian_mixed); break;
    }
    algorithm_embedding().projected.push_back(std::move(p));
  }

  int mass() {
    const int to =
        function_.computes(Quantity::mass_matrix) ? output(Quantity::mass_matrix) : room("mass", tree_.nv(), tree_.nv());
    if (!projected_mass_) project(Kind::both, Quantity::mass_matrix, to);
    projected_mass_ = true;
    return to;
  }

  int factor() {
    const int nv = tree_.nv(), own_mass = mass();
    const int upper =
        function_.computes(Quantity::mass_matrix_factor) ? output(Quantity::mass_matrix_factor) : room("factor", nv, nv);
    if (algorithm_.guard) return upper;
    const int longest = ir::most_above(ir::coordinate_tree(tree_)) + 1;
    const int unscaled = room("unscaled_factor", factor_stride(longest), nv);
    algorithm_.guard = ir::Guard{room("pivots", nv, 1), room("diagonal", nv, 1), {}, upper};
    // Before what solves.
    algorithm_.kernels.insert(algorithm_.kernels.begin(),
                              ir::Kernel(ir::Kernel::Kind::factor, {{ir::Operand::mass, own_mass},
                                                                    {ir::Operand::unscaled, unscaled},
                                                                    {ir::Operand::factor, upper},
                                                                    {ir::Operand::pivots, algorithm_.guard->pivots},
                                                                    {ir::Operand::diagonal, algorithm_.guard->diagonal}}));
    return upper;
  }
  void guard(int to) { algorithm_.guard->arrays.push_back(to); }

  void finish() {
    ir::Embedding& e = algorithm_embedding();
    e.called = own_.name;
    std::sort(own_.quantities.begin(), own_.quantities.end());
    const int count = static_cast<int>(ir::followers(tree_).elements.size()), all = opened_.nv();
    e.elements = room("followers", count, 1);
    e.accelerated = own_.inputs == ir::Function::inverse_dynamics;
    const bool turns = e.accelerated || std::any_of(e.projected.begin(), e.projected.end(), [](const ir::Projected& p) {
                         return p.kind == Kind::both_turned || p.kind == Kind::turned || p.kind == Kind::rows_of_turned;
                       });
    if (turns && !scene_.rates_zero) e.rates = room("follower_rates", count, 1);
    e.speeds = room("speeds_of_all_joints", all, 1);
    e.of_input = e.accelerated && function_.inputs == ir::Function::inverse_dynamics;
    if (e.accelerated) e.accelerations = room("accelerations_of_all_joints", all, 1);
  }

  const ir::EmittedFunction& function_;
  const ir::KinematicTree& tree_;
  const ir::KinematicTree opened_;
  const ir::Scene& scene_;
  ir::Algorithm algorithm_;
  ir::EmittedFunction own_;
  bool projected_mass_ = false;
};

}  // namespace

EmbeddedFunction embed(const ir::EmittedFunction& function, const ir::KinematicTree& tree, const ir::Scene& scene) {
  return Embed(function, tree, scene).run();
}

ir::Scene opened(const ir::Scene& scene) {
  ir::Scene own = scene;
  own.embedded.clear();
  own.outputs.clear();
  own.functions.clear();
  own.jacobians.clear();
  own.frames.clear();
  own.parallel = ir::Parallel::serial;
  own.forward_dynamics.reset();
  own.plan.clear();
  for (const auto& [name, how] : scene.plan) {
    ir::FunctionPlan form = how;
    form.solver.reset();  // M is factored behind it
    own.plan.emplace(name + "_of_all_joints", form);
  }
  return own;
}

}  // namespace dalembert::passes
