// What the compiler made of the scene: form, limbs, lanes, what it left out, sparsity, operations.
#pragma once

#include "commands/report/rows.hpp"
#include "commands/report/subject.hpp"

namespace dalembert::reporting {

// Rows of the sections `form`, `left_out`, `operations` and `sparsity`.
void add_forms(const Subject& subject, Rows& rows);

}  // namespace dalembert::reporting
