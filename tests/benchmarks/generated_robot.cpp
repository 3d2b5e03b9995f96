#include "generated_robot.hpp"

#include "generated_table.hpp"

namespace dalembert::benchmarks {

const GeneratedRobot* find_generated(const std::string& robot, const std::string& outputs) {
  for (const GeneratedRobot& generated : generated_robots) {
    if (robot == generated.robot && outputs == generated.outputs) return &generated;
  }
  return nullptr;
}

Results GeneratedEvaluation::results(int nv) const {
  const void* workspace = workspace_.get();
  Results results;
  const auto matrix = [&](const double* data) { return Eigen::Map<const Eigen::MatrixXd>(data, nv, nv); };
  const auto vector = [&](const double* data) { return Eigen::Map<const Eigen::VectorXd>(data, nv); };
  if (robot_.mass_matrix) results.mass_matrix = matrix(robot_.mass_matrix(workspace));
  if (robot_.coriolis_matrix) results.coriolis_matrix = matrix(robot_.coriolis_matrix(workspace));
  if (robot_.gravity) results.gravity = vector(robot_.gravity(workspace));
  if (robot_.bias) results.bias = vector(robot_.bias(workspace));
  return results;
}

}  // namespace dalembert::benchmarks
