// `dalembert info`: the robot as the compiler sees it.
#pragma once

#include <string>

#include "pipeline.hpp"

namespace dalembert {

// The tree with its joints numbered, the order of coordinates, bodies with masses, the table from link to body, and the
// sparsity of M.
std::string describe(const Model& model);

}  // namespace dalembert
