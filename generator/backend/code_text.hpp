// Pieces of text that more than one emitted file needs: inputs, results, indices.
#pragma once

#include <string>

#include "backend/emit.hpp"

namespace dalembert::backend {

// The text of an input on the evaluation path: q[7], v[6], workspace.gravity_vector[2], workspace.payload_hand.mass …
std::string input_text(const CodeInput& code, const ir::Input& input);

// `row + nv * column` worked out.
int element_index(const ir::OutputArray& array, int row, int column);

}  // namespace dalembert::backend
