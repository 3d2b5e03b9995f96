// How many operations one evaluation of the printed text executes: with the padding of limbs to equal length and of loops to
// whole registers, and with the zeros and ones that a loop reads from tables where the program as written has folded them.
#pragma once

#include "backend/emit.hpp"

namespace dalembert::backend {

// Loops over slots and rows are taken to run this many at a time (DALEMBERT_LANES, or what AVX has); other widths pad
// otherwise.
inline constexpr int counted_lanes = 4;

// A sine and a cosine of one angle count as one pair; what happens inside is not counted, nor are changes of sign, copies and
// comparisons.
ir::Operations executed_operations(const CodeInput& code);

}  // namespace dalembert::backend
