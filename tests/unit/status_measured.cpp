#include "status_measured.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "both_forms.hpp"
#include "reference/eigenvalues.hpp"
#include "reference/engine.hpp"

namespace dalembert::status_family {
namespace {

// Joints that nearly depend on one another stand at zero, but for the first.
State state_of(const Shape& shape, const ir::KinematicTree& tree) {
  State state = some_state(tree);
  for (int k = shape.before + 1; k < shape.before + shape.joints; ++k) state.q[tree.nq() - tree.joints() + k] = 0;
  return state;
}

double right_digits(const Eigen::MatrixXd& x, const Eigen::MatrixXd& exact) {
  const double error = (x - exact).cwiseAbs().maxCoeff<Eigen::PropagateNaN>() / exact.cwiseAbs().maxCoeff();
  return std::isnan(error) ? -99 : std::min(16.0, -std::log10(std::max(error, 1e-17)));
}

}  // namespace

Measured measure(const Shape& shape, double distance, unsigned seed) {
  Model model;
  model.tree = robot(shape, distance, seed);
  const State state = state_of(shape, model.tree);
  const reference::Inputs inputs{state.q, state.v, state.more, {}};
  const auto evaluated = [&](ir::Quantity quantity, reference::Precision precision) {
    return reference::evaluate(model.tree, model.scene, {{quantity, {}}}, inputs, precision).front();
  };
  Measured measured;
  Eigen::MatrixXd M = evaluated(ir::Quantity::mass_matrix, reference::Precision::digits_50);
  const Eigen::VectorXd scale = M.diagonal().cwiseSqrt().cwiseInverse();
  M = (scale.asDiagonal() * M * scale.asDiagonal()).eval();
  const Eigen::VectorXd values = reference::eigenvalues(M);
  measured.condition = values.maxCoeff() / std::max(values.minCoeff(), 1e-17);
  for (const auto& [function, quantity] : {std::pair{ir::Function::forward_dynamics, ir::Quantity::forward_dynamics},
                                           std::pair{ir::Function::evaluate, ir::Quantity::inverse_mass_matrix}}) {
    const std::string name = quantity == ir::Quantity::forward_dynamics ? "v̇" : "M⁻¹";
    const Eigen::MatrixXd exact = evaluated(quantity, reference::Precision::digits_50);
    measured.exact = (exact.array() != 0).any();
    const auto add = [&](const std::string& way, const Eigen::MatrixXd& x, std::optional<double> status) {
      const bool ok = status ? *status < 0 : (x.array() != 0).any();
      measured.ways.push_back({name + " " + way, ok, ok || !status ? -1 : static_cast<int>(*status), right_digits(x, exact)});
    };
    ir::EmittedFunction own = ir::standard_function(function);
    own.quantities = {quantity};
    for (const ir::Solver solver : {ir::Solver::articulated_bodies, ir::Solver::factorization}) {
      const auto forms = run_function(own, model, state, {}, {}, solver);
      const std::string by = solver == ir::Solver::articulated_bodies ? "bodies" : "factors";
      for (const std::size_t form : {0u, 1u})
        add(by + (form == 0 ? " straight" : " rolled"), forms[form].at(own.result(quantity)), forms[form].at("status")(0, 0));
    }
    add("generic", evaluated(quantity, reference::Precision::float64), {});
    add("generic float", evaluated(quantity, reference::Precision::float32), {});
  }
  return measured;
}

}  // namespace dalembert::status_family
