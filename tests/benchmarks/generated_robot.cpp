#include "generated_robot.hpp"

#include "generated_table.hpp"

namespace dalembert::benchmarks {

const GeneratedRobot* find_generated(const std::string& robot, const std::string& outputs) {
  for (const GeneratedRobot& generated : generated_robots) {
    if (robot == generated.robot && outputs == generated.outputs) return &generated;
  }
  return nullptr;
}

Results GeneratedEvaluation::results(const ir::KinematicTree& tree) const {
  Results results;
  for (const GeneratedOutput& output : robot_.results) {
    if (!output.values) continue;
    const ir::QuantityRow& row = ir::row_of(output.quantity);
    results[output.quantity] = Eigen::Map<const Eigen::MatrixXd>(output.values(workspace_.get()), ir::extent(row.rows, tree),
                                                                 ir::extent(row.columns, tree));
  }
  return results;
}

}  // namespace dalembert::benchmarks
