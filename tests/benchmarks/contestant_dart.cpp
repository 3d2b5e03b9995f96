// DART, through the oracle that the tests use.
#include <benchmark/benchmark.h>

#include <memory>

#include "contestants.hpp"
#include "dart_oracle.hpp"
#include "oracle_request.hpp"

namespace dalembert::benchmarks {
namespace {

using ir::Quantity;
using oracle::DartOracle;

struct Computation {
  DartOracle dart;
  Quantities quantities;
  std::vector<DartOracle::Coordinates> states;
  std::vector<Eigen::VectorXd> accelerations, forces;
  Eigen::VectorXd result;

  Computation(const BenchmarkRobot& robot, Quantities wanted) : dart(request_for(robot)), quantities(wanted) {
    for (int i = 0; i < BenchmarkRobot::state_count; ++i) {
      const testing::State& state = robot.states()[static_cast<size_t>(i)];
      states.push_back(dart.own_coordinates(state.q, state.v));
      accelerations.push_back(dart.own_vector(robot.more(ir::Function::inverse_dynamics, i)));
      forces.push_back(dart.own_vector(robot.more(ir::Function::forward_dynamics, i)));
    }
  }

  void run(int state) {
    const auto index = static_cast<size_t>(state);
    dart.set_state(states[index]);
    const double* finished = nullptr;
    switch (quantities) {
      case Quantities::M: finished = dart.own_mass_matrix().data(); break;
      case Quantities::gravity: finished = dart.own_gravity().data(); break;
      case Quantities::bias: finished = dart.own_bias().data(); break;
      case Quantities::inverse_dynamics: result = dart.own_inverse_dynamics(accelerations[index]); break;
      case Quantities::forward_dynamics: result = dart.own_forward_dynamics(forces[index]); break;
      default: break;
    }
    benchmark::DoNotOptimize(finished);
    benchmark::DoNotOptimize(result.data());
  }
};

}  // namespace

// Its inverse of M forgets what hangs on a welded link (see dart_oracle.cpp).
bool dart_offers(Quantities quantities) {
  switch (quantities) {
    case Quantities::M:
    case Quantities::gravity:
    case Quantities::bias:
    case Quantities::inverse_dynamics:
    case Quantities::forward_dynamics: return true;
    default: return false;
  }
}

Contestant dart_contestant(const BenchmarkRobot& robot, Quantities quantities) {
  if (!dart_offers(quantities)) return {};
  const auto c = std::make_shared<Computation>(robot, quantities);
  Contestant contestant;
  contestant.run = [c](int state) { c->run(state); };
  contestant.results = [c, &robot, quantities](int index) -> Results {
    const testing::State& state = robot.states()[static_cast<size_t>(index)];
    if (quantities == Quantities::inverse_dynamics || quantities == Quantities::forward_dynamics) {
      c->run(index);
      const bool inverse = quantities == Quantities::inverse_dynamics;
      return {{inverse ? Quantity::inverse_dynamics : Quantity::forward_dynamics, c->dart.our_vector(c->result)}};
    }
    const oracle::Dynamics dynamics = c->dart.evaluate(state.q, state.v);
    if (quantities == Quantities::M) return {{Quantity::mass_matrix, dynamics.mass_matrix}};
    if (quantities == Quantities::gravity) return {{Quantity::gravity, dynamics.gravity}};
    return {{Quantity::bias, dynamics.bias}};
  };
  return contestant;
}

}  // namespace dalembert::benchmarks
