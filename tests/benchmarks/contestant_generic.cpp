// The generic engine: the paper's recursion as printed, on any tree.
#include <dalembert/generic/dynamics.hpp>

#include "contestants.hpp"
#include "reference/generic_model.hpp"

namespace dalembert::benchmarks {

Contestant generic_contestant(const BenchmarkRobot& robot, Quantities quantities) {
  struct Computation {
    generic::Model<double> model;
    const std::vector<testing::State>& states;
    Quantities quantities;
    Results results;

    void run(int index) {
      const testing::State& state = states[static_cast<size_t>(index)];
      switch (quantities) {
        case Quantities::M: results.mass_matrix = generic::mass_matrix<double>(model, state.q); break;
        case Quantities::C: results.coriolis_matrix = generic::coriolis_matrix<double>(model, state.q, state.v); break;
        case Quantities::gravity: results.gravity = generic::gravity<double>(model, state.q); break;
        case Quantities::bias: results.bias = generic::bias<double>(model, state.q, state.v); break;
        case Quantities::M_and_C: {
          const auto kinematics = generic::phase1<double>(model, state.q, state.v);
          const auto composites = generic::phase2(model, kinematics);
          results.mass_matrix = generic::phase3_mass_matrix(model, kinematics, composites);
          results.coriolis_matrix = generic::phase3_coriolis_matrix(model, kinematics, composites);
        }
      }
    }
  };
  const auto computation = std::make_shared<Computation>(
      Computation{to_generic<double>(robot.tree(), robot.gravity()), robot.states(), quantities, {}});
  return {[computation](int state) { computation->run(state); },
          [computation](int state) {
            computation->run(state);
            return computation->results;
          }};
}

}  // namespace dalembert::benchmarks
