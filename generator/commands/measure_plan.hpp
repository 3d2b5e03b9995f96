// `--plan measure`: the ways to compute each function compiled and timed here, and the fastest kept.
#pragma once

#include <string>

#include "commands/compiler.hpp"
#include "frontend/scene_plan.hpp"
#include "pipeline.hpp"

namespace dalembert {

struct MeasuredPlan {
  frontend::ScenePlan plan;  // of functions that can be computed in more than one way
  std::string text;          // the times, a line per way
};

// Generates, compiles and times each function in every way that is not estimated to take more than twice the time of the best:
// straight in each order, rolled; by each solver. Ways take turns, so that what the machine does to one it does to all. Takes
// as many runs of the compiler as the function with the most ways has. Throws InputError as LoadedCode does.
MeasuredPlan measure_plan(const Model& model, const CompilerOptions& options);

// Whether the request says `--plan measure`.
bool asks_to_measure(const Request& request);

// The request with what was measured in its place: in the scene file, where there is one, which is rewritten with nothing but
// its plan changed; else as the option's value. The command that remakes the code then gives the same bytes. `told`: what to
// tell the user.
Request with_measured_plan(Request request, const CompilerOptions& options, std::string& told);

}  // namespace dalembert
