// Whether links and joints make one tree.
#pragma once

#include <string>

#include "diagnostics.hpp"
#include "frontend/urdf_outline.hpp"

namespace dalembert::frontend {

// Links, and joints, of one robot.
inline constexpr size_t most_links = 100'000;

// Throws InputError when there are too many links or joints, or naming every joint whose parent or child does not exist, that
// joins a link to itself, or whose child already has a parent; then every cycle; then two roots. Takes time in proportion to
// the file.
void check_topology(const std::string& file, const UrdfOutline& outline);

}  // namespace dalembert::frontend
