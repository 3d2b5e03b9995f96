// A robot, the states it is evaluated in and the right results there: shared by all programs that are compared.
#pragma once

#include <Eigen/Core>
#include <dalembert/generic/model.hpp>
#include <memory>
#include <string>
#include <vector>

#include "ir/kinematic_tree.hpp"
#include "states.hpp"

namespace dalembert::benchmarks {

enum class Quantities { M, C, M_and_C, gravity, bias };
inline constexpr Quantities all_quantities[] = {Quantities::M, Quantities::C, Quantities::M_and_C, Quantities::gravity,
                                                Quantities::bias};
const char* label(Quantities quantities);  // "M", "C", "M+C", "g", "bias"

// Results in double; those not computed are empty.
struct Results {
  Eigen::MatrixXd mass_matrix, coriolis_matrix;
  Eigen::VectorXd gravity, bias;
};

// M, C, g and bias in 100 decimal digits, rounded to double.
Results exact_results(const ir::KinematicTree& tree, const Eigen::Vector3d& gravity, const testing::State& state);

// The same in double, by the generic engine.
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

  // Of state `index`. Computed once, when first asked for.
  const Results& exact(int index) const;

 private:
  std::string name_, urdf_;
  ir::KinematicTree tree_;
  Eigen::Vector3d gravity_{0, 0, -9.81};
  std::vector<testing::State> states_;
  mutable std::vector<std::unique_ptr<Results>> exact_;
};

// Largest difference relative to the largest exact element, over the results that `ours` has; infinite if not finite.
double relative_error(const Results& ours, const Results& exact);

// Largest difference in units of the last place of the largest exact element; infinite if not finite.
double ulp_error(const Eigen::MatrixXd& ours, const Eigen::MatrixXd& exact);

}  // namespace dalembert::benchmarks
