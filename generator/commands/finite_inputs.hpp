// Numbers of a state that are nan or infinite.
#pragma once

#include <string>

#include "commands/output.hpp"
#include "commands/state_file.hpp"
#include "pipeline.hpp"

namespace dalembert {

// Throws InputError when the output depends on a number of the state that is not finite, with its line, place and name. Whether
// it does is tried out: the generic engine is asked with other numbers in its place. What does not count may be nan, as long as
// the result that the engine in use gave is finite.
void check_finite_inputs(const Model& model, const Output& output, const std::string& state_file, const State& state,
                         bool result_is_finite);

}  // namespace dalembert
