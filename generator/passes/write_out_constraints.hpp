// Kernels of constraints' rows as nodes (passes/write_out.hpp).
#pragma once

#include "ir/kernel.hpp"
#include "passes/written_matrices.hpp"

namespace dalembert::passes {

// Whether there are nodes for it.
bool can_be_written_out(const ir::Kernel& kernel);

// By the same equations as the runtime (dalembert/constraints.hpp), the proximal steps' last as a correction too, but by
// factors of all rows' inverse inertia instead of its inverse. A row that does not act has zeros, a one on its diagonal and
// nothing on the right. What the kernels tell of redundancy is left out: nobody can read it of many states.
void write_out_constraints(const ir::Kernel& kernel, WrittenMatrices& matrices);

const char* equation_of_constraints(const ir::Kernel& kernel);

}  // namespace dalembert::passes
