// What a call of a function's code is expected to take: a model of a processor's units, made to choose between ways to compute
// the same. Its constants were fitted to measured times by tests/benchmarks/forms.py.
#pragma once

#include <array>

#include "backend/emit.hpp"
#include "backend/emit_rolled.hpp"

namespace dalembert::backend {

// What the time is made of.
enum class Feature {
  call,             // one
  scalar,           // operations of straight code, of the base and of what runs number by number
  fetched,          // these again, where first-level caches of instructions do not hold the code
  sines,            // registers of angles
  divide,           // divisions and square roots of straight code
  lanes,            // operations of loops over limbs, a register of lanes at a time
  waits,            // cycles that a line, or a loop from step to step, takes beyond its operations
  loops,            // loops that begin
  tiles,            // operations of blocks of matrices, a register at a time
  along,            // the same of long limbs, which need no shuffles
  stores,           // numbers stored one by one or register by register
  step_operations,  // of kernels
  step_chains,      // of these: chains of coordinates, each a call
};
inline constexpr int feature_count = 13;
using Features = std::array<double, feature_count>;
extern const char* const feature_names[feature_count];

// `lanes`: doubles that a register holds, 2, 4 or 8.
Features features(const CodeInput& code, int lanes);

// ns per unit of each feature, where nothing is measured on the machine.
const Features& committed_constants(int lanes);

// The registers that expectations are for: those of the machine they were measured on; else what most have today.
int usual_lanes(const CodeInput& code);

// ns per call.
double estimate(const CodeInput& code, int lanes);

// ns of one of the functions that the rolled form consists of.
double estimate(const CodeInput& code, const Stage& stage, int lanes);

// What choices are made for: of these most processors of today have the second.
inline constexpr std::array<int, 3> register_widths{2, 4, 8};
inline constexpr std::size_t usual_width = 1;

}  // namespace dalembert::backend
