// All outputs together by the generated task graph, on all cores.
#pragma once

#include "commands/report/rows.hpp"
#include "commands/report/subject.hpp"

namespace dalembert::reporting {

inline constexpr const char* task_graph_variant = "task graph";

// Adds to section `rounding`, quantity `all`, the time of the outputs together as a task graph in double, and how many elements
// of its results differ from those of the same code in one thread; or why there is none.
void add_task_graph(const Subject& subject, Rows& rows);

}  // namespace dalembert::reporting
