// Kernels of the runtime (generator/ir/kernels.def) in the terms of their definition, on dense matrices: what emitted code's
// are compared with.
#pragma once

#include <vector>

#include "interpret.hpp"

namespace dalembert::ir {

// All of the algorithm's, in order; then what its guard says ("status"), and what is not told where M is singular. above: the
// coordinate above each.
void run_kernels(const Algorithm& algorithm, Arrays& arrays, const std::vector<int>& above, const Acting& acting);

}  // namespace dalembert::ir
