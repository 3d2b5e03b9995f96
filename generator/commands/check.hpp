// `dalembert check`: generated code against the generic engine, in double and in 50 digits.
#pragma once

#include <string>

#include "commands/compiler.hpp"
#include "pipeline.hpp"

namespace dalembert {

struct CheckReport {
  std::string text;  // tables: outputs and their errors, functions and their times
  bool passed = true;
};

// Generates and compiles each of the scene's outputs alone (those of a function that it names in one) and all together, and
// compares them at random states, the same ones in every run; where there are constraints, at half of these some are off or
// give way. Errors are relative to the output's largest element over all
// states. Passes when none exceeds 1e-12 (1e-5 for float) and the emitted self-test passes.
CheckReport check(const Model& model, const CompilerOptions& options);

}  // namespace dalembert
