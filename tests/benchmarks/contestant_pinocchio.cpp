// Pinocchio, where the library of its algorithms is found (pinocchio/CMakeLists.txt).
#include <benchmark/benchmark.h>

#include <memory>

#include "commands/report/pinocchio.hpp"
#include "contestants.hpp"

namespace dalembert::benchmarks {
namespace {

using ir::Quantity;
using reporting::PinocchioRobot;

std::vector<Quantity> outputs_of(Quantities quantities) {
  switch (quantities) {
    case Quantities::M: return {Quantity::mass_matrix};
    case Quantities::C: return {Quantity::coriolis_matrix};
    case Quantities::M_and_C: return {Quantity::mass_matrix, Quantity::coriolis_matrix};
    case Quantities::gravity: return {Quantity::gravity};
    case Quantities::bias: return {Quantity::bias};
    case Quantities::inverse_dynamics: return {Quantity::inverse_dynamics};
    case Quantities::forward_dynamics: return {Quantity::forward_dynamics};
    case Quantities::inverse_mass_matrix: return {Quantity::inverse_mass_matrix};
    case Quantities::inverse_dynamics_derivatives: return {Quantity::inverse_dynamics_dq, Quantity::inverse_dynamics_dv};
    case Quantities::forward_dynamics_derivatives:
      return {Quantity::forward_dynamics_dq, Quantity::forward_dynamics_dv, Quantity::inverse_mass_matrix};
    case Quantities::momentum_matrix: return {Quantity::momentum_matrix};
    case Quantities::center_of_mass: return {Quantity::center_of_mass, Quantity::center_of_mass_jacobian};
    case Quantities::energy: return {Quantity::kinetic_energy, Quantity::potential_energy};
    case Quantities::regressor: return {Quantity::regressor};
  }
  return {};
}

}  // namespace

bool pinocchio_offers(Quantities quantities) {
  static const bool found = [] {
    try {
      PinocchioRobot robot({}, Eigen::Vector3d::Zero());
      return true;
    } catch (const std::runtime_error&) {
      return false;
    }
  }();
  return found && !outputs_of(quantities).empty();
}

std::string pinocchio_version() {
  const PinocchioRobot robot({}, Eigen::Vector3d::Zero());
  return "Pinocchio " + robot.version() + ", compiled by " + robot.compiled();
}

Contestant pinocchio_contestant(const BenchmarkRobot& robot, Quantities quantities) {
  const auto pinocchio = std::make_shared<PinocchioRobot>(robot.tree(), robot.gravity());
  const std::vector<Quantity> outputs = outputs_of(quantities);
  const PinocchioRobot::Call& call = *pinocchio->call(outputs);
  // Some functions take accelerations, others forces; those that take neither do not look.
  const bool forces = ir::row_of(outputs.front()).function == ir::Function::forward_dynamics;
  const ir::Function takes = forces ? ir::Function::forward_dynamics : ir::Function::inverse_dynamics;
  Contestant contestant;
  contestant.run = [=, &robot, &call](int index) {
    const testing::State& state = robot.states()[static_cast<size_t>(index)];
    pinocchio->run(call, state.q.data(), state.v.data(), robot.more(takes, index).data());
  };
  contestant.results = [=, &robot, &call, run = contestant.run](int index) {
    run(index);
    Results results;
    for (const Quantity quantity : outputs) {
      const ir::QuantityRow& row = ir::row_of(quantity);
      const int rows = ir::extent(row.rows, robot.tree()), columns = ir::extent(row.columns, robot.tree());
      Eigen::MatrixXd result = pinocchio->result(call, quantity, rows, columns);
      // Its C is Christoffel's, ours balance's: what they have in common is C v.
      if (quantity == Quantity::coriolis_matrix) {
        const testing::State& state = robot.states()[static_cast<size_t>(index)];
        results[Quantity::bias] = result * state.v + robot.exact(Quantity::gravity, index);
      } else {
        results[quantity] = std::move(result);
      }
    }
    return results;
  };
  return contestant;
}

}  // namespace dalembert::benchmarks
