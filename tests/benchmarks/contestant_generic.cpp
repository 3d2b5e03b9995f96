// The generic engine: the paper's recursion as printed, on any tree.
#include <dalembert/generic/dynamics.hpp>
#include <dalembert/generic/whole_robot.hpp>
#include <memory>
#include <utility>

#include "contestants.hpp"
#include "reference/generic_model.hpp"

namespace dalembert::benchmarks {
namespace {

using ir::Quantity;

// M and C from phases I and II in common; energies from phase I.
Results evaluate(const generic::Model<double>& model, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                 Quantities quantities) {
  const auto kinematics = generic::phase1<double>(model, q, v);
  switch (quantities) {
    case Quantities::M_and_C: {
      const auto composites = generic::phase2(model, kinematics);
      return {{Quantity::mass_matrix, generic::phase3_mass_matrix(model, kinematics, composites)},
              {Quantity::coriolis_matrix, generic::phase3_coriolis_matrix(model, kinematics, composites)}};
    }
    case Quantities::momentum_matrix: {
      const auto composites = generic::phase2(model, kinematics);
      return {{Quantity::momentum_matrix, generic::expanded_momentum_matrix<double>(model, kinematics, composites, q)}};
    }
    case Quantities::center_of_mass:
      return {{Quantity::center_of_mass, generic::center_of_mass<double>(model, kinematics, q)},
              {Quantity::center_of_mass_jacobian, generic::expanded_center_of_mass_jacobian<double>(model, kinematics, q)}};
    case Quantities::energy:
      return {{Quantity::kinetic_energy,
               Eigen::MatrixXd::Constant(1, 1, generic::expanded_kinetic_energy<double>(model, kinematics, v))},
              {Quantity::potential_energy,
               Eigen::MatrixXd::Constant(1, 1, generic::potential_energy<double>(model, kinematics, q))}};
    default: return {};
  }
}

Results compute(const generic::Model<double>& model, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                const Eigen::VectorXd& v_dot, const Eigen::VectorXd& tau, Quantities quantities) {
  switch (quantities) {
    case Quantities::M: return {{Quantity::mass_matrix, generic::mass_matrix<double>(model, q)}};
    case Quantities::C: return {{Quantity::coriolis_matrix, generic::coriolis_matrix<double>(model, q, v)}};
    case Quantities::gravity: return {{Quantity::gravity, generic::gravity<double>(model, q)}};
    case Quantities::bias: return {{Quantity::bias, generic::bias<double>(model, q, v)}};
    case Quantities::inverse_dynamics:
      return {{Quantity::inverse_dynamics, generic::inverse_dynamics<double>(model, q, v, v_dot)}};
    case Quantities::forward_dynamics:
      return {{Quantity::forward_dynamics, generic::forward_dynamics<double>(model, q, v, tau).value}};
    case Quantities::inverse_mass_matrix:
      return {{Quantity::inverse_mass_matrix, generic::inverse_mass_matrix<double>(model, q).value}};
    case Quantities::inverse_dynamics_derivatives: {
      auto derivatives = generic::inverse_dynamics_derivatives<double>(model, q, v, v_dot);
      return {{Quantity::inverse_dynamics_dq, std::move(derivatives.dq)},
              {Quantity::inverse_dynamics_dv, std::move(derivatives.dv)}};
    }
    case Quantities::forward_dynamics_derivatives: {
      auto derivatives = generic::forward_dynamics_derivatives<double>(model, q, v, tau);
      return {{Quantity::forward_dynamics_dq, std::move(derivatives.dq)},
              {Quantity::forward_dynamics_dv, std::move(derivatives.dv)},
              {Quantity::inverse_mass_matrix, generic::inverse_mass_matrix<double>(model, q).value}};
    }
    case Quantities::regressor: return {{Quantity::regressor, generic::regressor<double>(model, q, v, v_dot)}};
    case Quantities::M_and_C:
    case Quantities::momentum_matrix:
    case Quantities::center_of_mass:
    case Quantities::energy: break;
  }
  return evaluate(model, q, v, quantities);
}

}  // namespace

Contestant generic_contestant(const BenchmarkRobot& robot, Quantities quantities) {
  struct Computation {
    generic::Model<double> model;
    Results results;
  };
  const auto c = std::make_shared<Computation>(Computation{to_generic<double>(robot.tree(), robot.gravity()), {}});
  const auto run = [c, &robot, quantities](int index) {
    const testing::State& state = robot.states()[static_cast<size_t>(index)];
    c->results = compute(c->model, state.q, state.v, robot.more(ir::Function::inverse_dynamics, index),
                         robot.more(ir::Function::forward_dynamics, index), quantities);
  };
  return {run, [c, run](int state) {
            run(state);
            return c->results;
          }};
}

}  // namespace dalembert::benchmarks
