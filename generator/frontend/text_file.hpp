// A file as text, or a diagnostic that says why not.
#pragma once

#include <string>

namespace dalembert::frontend {

// Throws InputError when the file is missing, a directory, or cannot be read. `kind` names what was expected: "URDF".
std::string read_text_file(const std::string& path, const std::string& kind);

}  // namespace dalembert::frontend
