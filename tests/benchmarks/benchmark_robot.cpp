#include "benchmark_robot.hpp"

#include <algorithm>
#include <cmath>
#include <dalembert/generic/dynamics.hpp>
#include <limits>
#include <utility>

#include "load_robot.hpp"
#include "multiprecision.hpp"
#include "reference/engine.hpp"
#include "reference/generic_model.hpp"
#include "reference/instances.hpp"

namespace dalembert::benchmarks {
namespace {

double largest(const Eigen::MatrixXd& matrix) { return matrix.cwiseAbs().maxCoeff(); }

double error_of(const Eigen::MatrixXd& ours, const Eigen::MatrixXd& exact) {
  if (!ours.allFinite()) return std::numeric_limits<double>::infinity();
  return largest(ours - exact) / std::max(largest(exact), std::numeric_limits<double>::min());
}

}  // namespace

const char* label(Quantities quantities) { return all_quantities[static_cast<size_t>(quantities)].label; }

BenchmarkRobot::BenchmarkRobot(std::string name, std::string urdf, bool floating)
    : name_(std::move(name)),
      urdf_(std::move(urdf)),
      tree_(testing::load_robot({name_.c_str(), urdf_.c_str()}, floating)),
      exact_(state_count) {
  for (int i = 0; i < state_count; ++i) {
    const auto seed = static_cast<std::uint64_t>(i + 1);
    states_.push_back(testing::moderate_state(tree_, seed));
    testing::Random random(seed + state_count);
    const auto within = [&](double limit) -> Eigen::VectorXd {
      return Eigen::VectorXd::NullaryExpr(tree_.nv(), [&] { return random.uniform(-limit, limit); });
    };
    accelerations_.push_back(within(2));
    forces_.push_back(within(20));
  }
}

const Eigen::VectorXd& BenchmarkRobot::more(ir::Function function, int index) const {
  const auto at = static_cast<size_t>(index);
  switch (function) {
    case ir::Function::evaluate: break;
    case ir::Function::inverse_dynamics: return accelerations_[at];
    case ir::Function::forward_dynamics: return forces_[at];
  }
  return nothing_;
}

Results exact_results(const ir::KinematicTree& tree, const Eigen::Vector3d& gravity, const testing::State& state) {
  using testing::Multi;
  const auto model = to_generic<Multi>(tree, gravity);
  const VectorX<Multi> q = state.q.cast<Multi>(), v = state.v.cast<Multi>(), zero = VectorX<Multi>::Zero(v.size());
  Results results;
  results[ir::Quantity::mass_matrix] = generic::mass_matrix<Multi>(model, q).cast<double>();
  results[ir::Quantity::coriolis_matrix] = generic::coriolis_matrix<Multi>(model, q, v).cast<double>();
  results[ir::Quantity::gravity] = generic::inverse_dynamics<Multi>(model, q, zero, zero).cast<double>();
  results[ir::Quantity::bias] = generic::inverse_dynamics<Multi>(model, q, v, zero).cast<double>();
  return results;
}

Results generic_results(const generic::Model<double>& model, const testing::State& state) {
  generic::Dynamics<double> all = generic::evaluate<double>(model, state.q, state.v);
  return {{ir::Quantity::mass_matrix, std::move(all.mass_matrix)},
          {ir::Quantity::coriolis_matrix, std::move(all.coriolis_matrix)},
          {ir::Quantity::gravity, std::move(all.gravity)},
          {ir::Quantity::bias, std::move(all.bias)}};
}

const Eigen::MatrixXd& BenchmarkRobot::exact(ir::Quantity quantity, int index) const {
  Results& known = exact_[static_cast<size_t>(index)];
  const auto found = known.find(quantity);
  if (found != known.end()) return found->second;
  const testing::State& state = states_[static_cast<size_t>(index)];
  ir::Scene scene;
  scene.gravity = gravity_;
  const reference::Inputs inputs{state.q, state.v, more(ir::row_of(quantity).function, index)};
  return known[quantity] = reference::evaluate(tree_, scene, {{quantity, ""}}, inputs, reference::Precision::digits_50).front();
}

double relative_error(const Results& ours, const BenchmarkRobot& robot, int index) {
  double largest = ours.empty() ? std::numeric_limits<double>::infinity() : 0;
  for (const auto& [quantity, result] : ours) largest = std::max(largest, error_of(result, robot.exact(quantity, index)));
  return largest;
}

double ulp_error(const Eigen::MatrixXd& ours, const Eigen::MatrixXd& exact) {
  if (!ours.allFinite()) return std::numeric_limits<double>::infinity();
  const double difference = largest(ours - exact);
  if (difference == 0) return 0;
  if (largest(exact) == 0) return std::numeric_limits<double>::infinity();
  return difference / std::ldexp(1.0, std::max(std::ilogb(largest(exact)) - 52, -1074));
}

}  // namespace dalembert::benchmarks
