// Where the generator and its reader of SDF meet: the one function of a library that is opened at run time.
#pragma once

#include <string>

#include "diagnostics.hpp"
#include "frontend/urdf_outline.hpp"

// The one model of the file with those nested in it, poses resolved. Throws dalembert::InputError; appends to `warnings`.
extern "C" void dalembert_sdf_outline(const std::string& path, dalembert::Diagnostics& warnings,
                                      dalembert::frontend::UrdfOutline& outline);
