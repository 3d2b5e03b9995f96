// `dalembert generate`: a robot's dynamics as C++ files.
#pragma once

#include <string>

#include "pipeline.hpp"

namespace dalembert {

// Compiles the model and writes its files into the folder, all or none of them; returns a line that says so.
std::string generate(const Model& model, const std::string& folder);

// The same code for hosts in C: NAME.h, a C header, is all that is promised; what it declares is in code/, C++ inside.
std::string generate_c(const Model& model, const std::string& folder);

// Throws InputError where a file of rules is not called .d.
void check_depfile(const std::string& file);

// Writes a rule for make and ninja: the file, less its `.d`, is made of the robot's files and of the scene's, where there is
// one. Throws InputError where it cannot be written.
void write_depfile(const std::string& file, const Model& model, const std::string& scene_file);

}  // namespace dalembert
