// Who and what was measured, on what machine, when, against whom.
#pragma once

#include "commands/report/rows.hpp"
#include "commands/report/subject.hpp"

namespace dalembert::reporting {

// Rows of the section `robot`.
void add_heading(const Subject& subject, Rows& rows);

}  // namespace dalembert::reporting
