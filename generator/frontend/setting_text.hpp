// The value of a command-line option as YAML.
#pragma once

#include <string>

#include "frontend/yaml_text.hpp"

namespace dalembert::frontend {

// "[a, b]" and "{a: 1}" are YAML; "a,b" is a list; "a=1,b=2" a map; "g=0,0,1" a map with a list; anything else a scalar.
// Throws YamlError for malformed YAML.
YamlNode node_of(const std::string& text);

}  // namespace dalembert::frontend
