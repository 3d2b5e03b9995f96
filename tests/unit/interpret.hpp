// Runs what the compiler makes of an algorithm on numbers, in either form: what the emitted code must compute, without emitting
// it and without a compiler.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <string>

#include "ir/acting.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/plan.hpp"
#include "ir/program.hpp"
#include "ir/rolled.hpp"

namespace dalembert::ir {

using FunctionInput = std::function<double(const Input&)>;  // position, velocity, gravity, payload
using Arrays = std::map<std::string, Eigen::MatrixXd>;      // by name

// The straight form. `arrays`: those that sections before have filled.
Arrays run(const Algorithm& algorithm, const Program& program, const KinematicTree& tree, const FunctionInput& input,
           Arrays arrays = {}, const Acting& acting = {});

// The rolled form, likewise. Evaluated twice, the results being the second's: nothing may be left of the first.
Arrays run(const Algorithm& algorithm, const RolledProgram& program, const Plan& plan, const KinematicTree& tree,
           bool rates_zero, const FunctionInput& input, const Arrays& arrays = {}, const Acting& acting = {});

}  // namespace dalembert::ir
