// The registry of quantities as text, for people and for programs.
#pragma once

#include <string>

namespace dalembert {

// The quantities and those of links, a line each; and with the scene's keys as one JSON object.
std::string registry_text();
std::string registry_json();

}  // namespace dalembert
