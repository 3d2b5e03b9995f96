// What the rows and columns of a result are, in words: joints, bodies, axes.
#pragma once

#include <string>
#include <vector>

#include "commands/output.hpp"

namespace dalembert {

// A name per row and per column: "base_linear_x", "left_knee", "angular_z". Of a single number, of a vector's
// only column, none.
struct Labels {
  std::vector<std::string> rows, columns;
};

Labels labels_of(const Model& model, const Output& output);

// A symbol, a unit and help, as the registry has them; of a link, with its name.
struct Words {
  std::string symbol, unit, help;
};
Words words_of(const Output& output);

}  // namespace dalembert
