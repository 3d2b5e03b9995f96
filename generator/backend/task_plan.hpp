// Which tasks a function's stages are divided into: as few as pay, each with what it is expected to take.
#pragma once

#include "backend/emit.hpp"
#include "ir/task_graph.hpp"

namespace dalembert::backend {

// By what code.plan says of sweeps.
ir::TaskPlan plan_tasks(const CodeInput& code);

// Whether more is expected of threads that sweep for themselves than of sweeps that are divided.
bool better_apart(const CodeInput& code);

// The most that the code asks for.
int threads_of(const CodeInput& code, const ir::TaskPlan& plan);

}  // namespace dalembert::backend
