// `dalembert calibrate`: what this machine takes for what calls are made of.
#pragma once

#include <memory>
#include <string>

#include "commands/compiler.hpp"
#include "ir/machine_costs.hpp"

namespace dalembert {

struct Calibration {
  ir::MachineCosts costs;
  std::string text;  // what was measured beside what is expected by these constants, and where they are kept
};

// Generates, compiles and times programs of many shapes, fits the constants of backend/estimate.hpp to them, and keeps these in
// the cache for this machine (in place of earlier ones). Takes a minute or two. Throws InputError where there is no compiler,
// or the cache cannot be written.
Calibration calibrate(const CompilerOptions& options);

// What was kept for this machine. Throws InputError when there is nothing, or nothing that can be read.
std::shared_ptr<const ir::MachineCosts> calibrated_costs();

// As kept in a file, and read from it; `where` is told in errors.
std::string costs_text(const ir::MachineCosts& costs);
ir::MachineCosts costs_of_text(const std::string& text, const std::string& where);

}  // namespace dalembert
