// `dalembert eval`: one quantity at given states.
#pragma once

#include <string>

#include "commands/compiler.hpp"
#include "diagnostics.hpp"
#include "pipeline.hpp"

namespace dalembert {

enum class Engine { generic, generated, batch };  // batch: generated, all states in one call

// numbers: row by row, numbers with 17 digits separated by blanks, states separated by an empty line. labels: the same in
// columns, behind the name of each row and below the names of columns. json: one object with name, symbol, unit, the names of
// rows and columns, and the results, a list of rows for each state; what is no finite number is null.
enum class Style { numbers, labels, json };

// The output at every state of the file, as text. Warns about states whose result is not finite.
std::string evaluate(const Model& model, const std::string& state_file, const std::string& output, Engine engine, Style style,
                     const CompilerOptions& options, Diagnostics& warnings);

}  // namespace dalembert
