// The generic engine behind the commands: the paper's recursion on the model's tree, in double or in 50 digits.
#pragma once

#include <Eigen/Core>

#include "commands/output.hpp"
#include "commands/state_file.hpp"
#include "pipeline.hpp"
#include "reference/engine.hpp"

namespace dalembert {

reference::Inputs inputs(const State& state);

// The output at the state, rows × columns, computed in double. Run-time inputs have the scene's values.
Eigen::MatrixXd evaluate_generic(const Model& model, const Output& output, const State& state);

// The same computed in single precision.
Eigen::MatrixXd evaluate_single_precision(const Model& model, const Output& output, const State& state);

// The same computed in 50 decimal digits and rounded to double once, at the end.
Eigen::MatrixXd evaluate_multiprecision(const Model& model, const Output& output, const State& state);

}  // namespace dalembert
