// A scene's `plan` as text, and a scene file with another one.
#pragma once

#include <map>
#include <string>

#include "ir/scene.hpp"

namespace dalembert::frontend {

using ScenePlan = std::map<std::string, ir::FunctionPlan>;

// In one line, as an option takes it: "{evaluate: {form: straight, order: as_written}}".
std::string plan_setting(const ScenePlan& plan);

// As a scene file has it: "plan:" and a line per function, each behind `end_of_line`.
std::string plan_lines(const ScenePlan& plan, const std::string& end_of_line = "\n");

// The text of a scene file with this plan instead of the one it has, or behind all other keys where it has none; nothing else
// changes, not a byte. Throws InputError, with the lines to paste, where the file's form leaves no such place: a map in braces,
// a key that does not begin its line, an encoding other than UTF-8.
std::string with_plan(const std::string& file, const std::string& text, const ScenePlan& plan);

}  // namespace dalembert::frontend
