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

// Which code is compiled: that of all outputs, as `generate` writes it, and of each output alone as well (of a function that
// the scene names, those of the function in one).
enum class Pieces { each_and_together, together };

// Generates and compiles the scene's outputs, and compares them at random states, the same ones in every run; where there are
// constraints, at half of these some are off or give way. Errors are relative to the output's largest element over all states.
// Passes when none exceeds 1e-12 (1e-5 for float) and the emitted self-test passes.
CheckReport check(const Model& model, const CompilerOptions& options, Pieces which = Pieces::each_and_together);

}  // namespace dalembert
