// The value of a command-line option as a YAML node.
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

namespace dalembert::frontend {

// "[a, b]" and "{a: 1}" are YAML; "a,b" is a list; "a=1,b=2" a map; "g=0,0,1" a map with a list; anything else a scalar.
// Throws YAML::Exception for malformed YAML.
YAML::Node node_of(const std::string& text);

}  // namespace dalembert::frontend
