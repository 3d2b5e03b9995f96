// What each pass of the compiler makes of a robot, printed for people.
#pragma once

#include <string>

#include "pipeline.hpp"

namespace dalembert {

enum class Stage {
  tree,         // bodies and joints, after the scene: fixed, locked and cut joints are gone
  normal_tree,  // the same with every joint's axis as z, and inertial parameters moved towards the base
  program,      // the scalar program, phase by phase, nodes that no result needs left out
  plan,         // the shape of the code: form, segments, lanes
  rolled,       // the rolled form: per segment and paragraph the equation and the operations, padding included
};
// By the values of Stage.
inline constexpr const char* stage_names[] = {"tree", "normal_tree", "program", "plan", "rolled"};

// The stage's result, and the cost of the model's outputs after each pass.
std::string dump(const Model& model, Stage stage);

}  // namespace dalembert
