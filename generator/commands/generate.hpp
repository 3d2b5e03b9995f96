// `dalembert generate`: a robot's dynamics as C++ files.
#pragma once

#include <string>

#include "pipeline.hpp"

namespace dalembert {

// Compiles the model and writes its files into the folder, all or none of them; returns a line that says so.
std::string generate(const Model& model, const std::string& folder);

// The same code for hosts in C: NAME.h, a C header, is all that is promised; what it declares is in code/, C++ inside.
std::string generate_c(const Model& model, const std::string& folder);

}  // namespace dalembert
