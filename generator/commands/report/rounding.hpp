// Error against time: every output by itself, by every variant and by the generic engine.
#pragma once

#include "commands/report/rows.hpp"
#include "commands/report/subject.hpp"

namespace dalembert::reporting {

// Rows of section `rounding`: per output and variant the time per call (median, quartiles), the error at random states
// (norm-wise with quartiles and worst, in ulp, component-wise), and whether the variant is on the Pareto front of median time
// and worst error: nobody is both faster and more exact.
void add_rounding(const Subject& subject, Rows& rows);

inline constexpr const char* random_case = "random states";
inline constexpr const char* generic_variant = "generic double";

}  // namespace dalembert::reporting
