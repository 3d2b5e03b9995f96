// `dalembert info --threads`: what is expected of a function's tasks on so many threads, and the picture of it.
#pragma once

#include <string>
#include <vector>

#include "compile.hpp"

namespace dalembert {

// Per function: how many tasks, serial time, the longest way through them, the time expected on `threads` and on others.
std::string tasks_text(const std::vector<FunctionTasks>& functions, int threads);

// The graph of the function with most tasks, laid out in the time it is expected to take: a row a thread, a box a task, a line
// an edge that goes from thread to thread.
std::string tasks_svg(const std::vector<FunctionTasks>& functions, int threads);

}  // namespace dalembert
