// The back of the compiler: what a model was lowered to becomes text.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "backend/estimate.hpp"
#include "backend/task_plan.hpp"
#include "lower.hpp"

namespace dalembert {

// sizeof(Workspace) of the generated code, in bytes.
std::size_t workspace_bytes(const Model& model, const Lowered& lowered);

// Operations that one call of each generated function executes, padding included (backend/executed.hpp).
std::vector<std::pair<std::string, ir::Operations>> executed_operations(const Model& model, const Lowered& lowered);

// What the estimate of each generated function's time is made of (backend/estimate.hpp), for registers of so many doubles.
std::vector<std::pair<std::string, backend::Features>> features(const Model& model, const Lowered& lowered, int lanes);

// Where the scene leaves it to the compiler (parallel: auto), functions for which two threads are expected to be worth it get a
// task graph. Of each graph: whether threads sweep for themselves.
void decide_tasks(const Model& model, Lowered& lowered);

// Each function's tasks, whether its graph is generated or not.
struct FunctionTasks {
  std::string function;
  bool emitted = false;
  ir::TaskPlan plan;
  int lanes = 4;    // of the registers that this is expected on
  int threads = 1;  // the most that the code asks for
};
std::vector<FunctionTasks> tasks_of_functions(const Model& model, Lowered lowered);

// The functions of a scene with batches that compute states in lanes: others are called state by state. None where the results
// of one are more than batches take.
std::vector<std::string> functions_in_lanes(const Model& model, const Lowered& lowered);

}  // namespace dalembert
