// The examples of examples/scenes as this build has compiled them, each behind its C API.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "commands/output.hpp"
#include "commands/random_states.hpp"

namespace dalembert::scenes {

struct Example {
  std::string name;     // namespace of the code
  std::string meaning;  // for the page
  Model model;          // what the compiler worked on
  std::string archive;  // static library
  std::size_t workspace_bytes;

  std::function<std::shared_ptr<void>()> workspace;  // a new one
  std::function<void(const double* q, const double* v, void*)> evaluate;
  std::vector<std::pair<Output, std::function<const double*(const void*)>>> results;  // output and where it is in a workspace
};

// The five scenes, then the full humanoid with the outputs of legs_only.
const std::vector<Example>& examples();
const Example& example(const std::string& name);

// Largest difference relative to the largest element, over states and outputs, of the compiled code to the generic engine.
double error_of(const Example& example, const std::vector<State>& states);

}  // namespace dalembert::scenes
