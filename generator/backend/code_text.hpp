// Pieces of text that more than one emitted file needs: inputs, results, indices.
#pragma once

#include <string>

#include "backend/emit.hpp"

namespace dalembert::backend {

// The text of an input on the evaluation path: q[7], v[6], workspace.gravity_vector[2], workspace.payload_hand.mass …
std::string input_text(const CodeInput& code, const ir::Input& input);

// `row + nv * column` worked out.
int element_index(const ir::OutputArray& array, int row, int column);

// Which inputs a program's results depend on.
struct InputsRead {
  bool position = false;   // joint positions
  bool base_pose = false;  // the floating base's orientation (its position is never read)
  bool velocity = false;
};
InputsRead inputs_read(const ir::Program& program);

}  // namespace dalembert::backend
