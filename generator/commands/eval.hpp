// `dalembert eval`: one quantity at given states.
#pragma once

#include <string>

#include "commands/compiler.hpp"
#include "diagnostics.hpp"
#include "pipeline.hpp"

namespace dalembert {

enum class Engine { generic, generated, batch };  // batch: generated, all states in one call

// The output at every state of the file, as text: row by row, numbers with 17 digits separated by blanks, states separated by
// an empty line. Warns about states whose result is not finite.
std::string evaluate(const Model& model, const std::string& state_file, const std::string& output, Engine engine,
                     const CompilerOptions& options, Diagnostics& warnings);

}  // namespace dalembert
