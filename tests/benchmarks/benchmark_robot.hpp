// A robot, the states it is evaluated in and the right results there: shared by all programs that are compared.
#pragma once

#include <Eigen/Core>
#include <dalembert/generic/model.hpp>
#include <map>
#include <string>
#include <vector>

#include "ir/kinematic_tree.hpp"
#include "ir/quantity.hpp"
#include "states.hpp"

namespace dalembert::benchmarks {

// What is timed together.
enum class Quantities {
  M,
  C,
  M_and_C,
  gravity,
  bias,
  inverse_dynamics,
  forward_dynamics,
  inverse_mass_matrix,
  inverse_dynamics_derivatives,  // by q and by v
  forward_dynamics_derivatives,  // by q, by v and by tau, which is the inverse of M
  momentum_matrix,
  center_of_mass,  // and its Jacobian
  energy,          // kinetic and potential
  regressor
};
struct QuantitiesRow {
  Quantities quantities;
  const char* label;  // in benchmarks' names, and in robots.cmake, which says which outputs that is
};
inline constexpr QuantitiesRow all_quantities[] = {{Quantities::M, "M"},
                                                   {Quantities::C, "C"},
                                                   {Quantities::M_and_C, "M+C"},
                                                   {Quantities::gravity, "g"},
                                                   {Quantities::bias, "bias"},
                                                   {Quantities::inverse_dynamics, "id"},
                                                   {Quantities::forward_dynamics, "fd"},
                                                   {Quantities::inverse_mass_matrix, "minv"},
                                                   {Quantities::inverse_dynamics_derivatives, "did"},
                                                   {Quantities::forward_dynamics_derivatives, "dfd"},
                                                   {Quantities::momentum_matrix, "cmm"},
                                                   {Quantities::center_of_mass, "com"},
                                                   {Quantities::energy, "energy"},
                                                   {Quantities::regressor, "regressor"}};
const char* label(Quantities quantities);

// Results in double, of the quantities that are computed.
using Results = std::map<ir::Quantity, Eigen::MatrixXd>;

// M, C, g and bias in 100 decimal digits, rounded to double.
Results exact_results(const ir::KinematicTree& tree, const Eigen::Vector3d& gravity, const testing::State& state);

// The same four in double, by the generic engine.
Results generic_results(const generic::Model<double>& model, const testing::State& state);

class BenchmarkRobot {
 public:
  static constexpr int state_count = 64;     // enough that nothing is predicted from call to call
  static constexpr int checked_states = 16;  // those whose exact results are computed

  BenchmarkRobot(std::string name, std::string urdf, bool floating);

  const std::string& name() const { return name_; }
  const std::string& urdf() const { return urdf_; }
  const ir::KinematicTree& tree() const { return tree_; }
  const Eigen::Vector3d& gravity() const { return gravity_; }
  const std::vector<testing::State>& states() const { return states_; }

  // What the function takes besides q and v at state `index`: accelerations within ±2, or forces within ±20; empty for
  // evaluate().
  const Eigen::VectorXd& more(ir::Function function, int index) const;

  // The quantity at state `index` in 50 decimal digits, rounded to double. Computed once, when first asked for.
  const Eigen::MatrixXd& exact(ir::Quantity quantity, int index) const;

 private:
  std::string name_, urdf_;
  ir::KinematicTree tree_;
  Eigen::Vector3d gravity_{0, 0, -9.81};
  std::vector<testing::State> states_;
  std::vector<Eigen::VectorXd> accelerations_, forces_;
  Eigen::VectorXd nothing_;
  mutable std::vector<Results> exact_;
};

// Largest difference relative to the largest exact element, over the results that `ours` has at state `index`; infinite if
// there are none, or one is not finite.
double relative_error(const Results& ours, const BenchmarkRobot& robot, int index);

// Largest difference in units of the last place of the largest exact element; infinite if not finite.
double ulp_error(const Eigen::MatrixXd& ours, const Eigen::MatrixXd& exact);

}  // namespace dalembert::benchmarks
