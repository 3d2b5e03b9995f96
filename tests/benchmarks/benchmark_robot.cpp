#include "benchmark_robot.hpp"

#include <algorithm>
#include <cmath>
#include <dalembert/generic/dynamics.hpp>
#include <limits>
#include <utility>

#include "load_robot.hpp"
#include "multiprecision.hpp"
#include "reference/generic_model.hpp"

namespace dalembert::benchmarks {
namespace {

double largest(const Eigen::MatrixXd& matrix) { return matrix.cwiseAbs().maxCoeff(); }

double error_of(const Eigen::MatrixXd& ours, const Eigen::MatrixXd& exact) {
  if (ours.size() == 0) return 0;
  if (!ours.allFinite()) return std::numeric_limits<double>::infinity();
  return largest(ours - exact) / std::max(largest(exact), std::numeric_limits<double>::min());
}

}  // namespace

const char* label(Quantities quantities) {
  switch (quantities) {
    case Quantities::M: return "M";
    case Quantities::C: return "C";
    case Quantities::M_and_C: return "M+C";
    case Quantities::gravity: return "g";
    case Quantities::bias: return "bias";
  }
  return "";
}

BenchmarkRobot::BenchmarkRobot(std::string name, std::string urdf, bool floating)
    : name_(std::move(name)),
      urdf_(std::move(urdf)),
      tree_(testing::load_robot({name_.c_str(), urdf_.c_str()}, floating)),
      exact_(state_count) {
  for (int i = 0; i < state_count; ++i) states_.push_back(testing::moderate_state(tree_, static_cast<std::uint64_t>(i + 1)));
}

Results exact_results(const ir::KinematicTree& tree, const Eigen::Vector3d& gravity, const testing::State& state) {
  using testing::Multi;
  const auto model = to_generic<Multi>(tree, gravity);
  const VectorX<Multi> q = state.q.cast<Multi>(), v = state.v.cast<Multi>(), zero = VectorX<Multi>::Zero(v.size());
  Results results;
  results.mass_matrix = generic::mass_matrix<Multi>(model, q).cast<double>();
  results.coriolis_matrix = generic::coriolis_matrix<Multi>(model, q, v).cast<double>();
  results.gravity = generic::inverse_dynamics<Multi>(model, q, zero, zero).cast<double>();
  results.bias = generic::inverse_dynamics<Multi>(model, q, v, zero).cast<double>();
  return results;
}

Results generic_results(const generic::Model<double>& model, const testing::State& state) {
  generic::Dynamics<double> all = generic::evaluate<double>(model, state.q, state.v);
  return {std::move(all.mass_matrix), std::move(all.coriolis_matrix), std::move(all.gravity), std::move(all.bias)};
}

const Results& BenchmarkRobot::exact(int index) const {
  const auto at = static_cast<size_t>(index);
  if (!exact_[at]) exact_[at] = std::make_unique<Results>(exact_results(tree_, gravity_, states_[at]));
  return *exact_[at];
}

double relative_error(const Results& ours, const Results& exact) {
  return std::max({error_of(ours.mass_matrix, exact.mass_matrix), error_of(ours.coriolis_matrix, exact.coriolis_matrix),
                   error_of(ours.gravity, exact.gravity), error_of(ours.bias, exact.bias)});
}

double ulp_error(const Eigen::MatrixXd& ours, const Eigen::MatrixXd& exact) {
  if (!ours.allFinite()) return std::numeric_limits<double>::infinity();
  const double difference = largest(ours - exact);
  if (difference == 0) return 0;
  if (largest(exact) == 0) return std::numeric_limits<double>::infinity();
  return difference / std::ldexp(1.0, std::max(std::ilogb(largest(exact)) - 52, -1074));
}

}  // namespace dalembert::benchmarks
