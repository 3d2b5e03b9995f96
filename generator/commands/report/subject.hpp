// What a report is about, and how thorough it is.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "commands/compiler.hpp"
#include "commands/output.hpp"
#include "commands/report/mujoco.hpp"
#include "commands/report/pinocchio.hpp"
#include "commands/state_file.hpp"
#include "pipeline.hpp"
#include "reference/engine.hpp"

namespace dalembert::reporting {

struct Subject {
  Model model;
  std::vector<Output> outputs;  // the scene's
  CompilerOptions compiler;
  bool quick = false;
  const Mujoco& mujoco;
  const Pinocchio& pinocchio;

  // Compiling is most of a quick report: where this holds, each output is compiled as users get it, in double, and no other
  // way, and all together without their task graph.
  bool many_outputs() const { return quick && outputs.size() > 4; }
};

// What is exact at a state, per output, and what its errors are measured against at least.
struct Exact {
  std::vector<Eigen::MatrixXd> results;
  std::vector<double> least_scales;
};

// In 50 digits, on the model's tree. Costs a few milliseconds.
Exact exact_at(const Model& model, const std::vector<Output>& outputs, const State& state);

// The outputs by the generic engine in double, its model made anew.
std::vector<Eigen::MatrixXd> generic_at(const Model& model, const std::vector<Output>& outputs, const State& state);

// The state with every number rounded to one that a float holds: what code in float is given.
State rounded_to_float(State state);

}  // namespace dalembert::reporting
