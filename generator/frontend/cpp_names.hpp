// Names of links and joints that can stand in C++.
#pragma once

#include <string>

#include "diagnostics.hpp"
#include "frontend/urdf_outline.hpp"

namespace dalembert::frontend {

// Appends '_' to the names of links and joints that are keywords of C++, of joints that are macros of its library, and of those
// that become equal to another's as identifiers, wherever they stand in the outline; warns about each.
void make_names_distinct(const std::string& file, UrdfOutline& outline, Diagnostics& warnings);

}  // namespace dalembert::frontend
