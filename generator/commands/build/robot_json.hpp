// What programs read of an entry of the cache beside the code: robot.json.
#pragma once

#include <cstdint>
#include <string>

#include "commands/build/library.hpp"
#include "commands/compiler.hpp"
#include "diagnostics.hpp"
#include "pipeline.hpp"

namespace dalembert {

std::string robot_json(const Library& library, const Request& request, const CompilerOptions& options,
                       std::uintmax_t code_bytes, const Diagnostics& warnings);

}  // namespace dalembert
