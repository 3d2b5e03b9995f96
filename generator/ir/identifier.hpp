// Names of links, joints and robots as C++ identifiers: the one place that says how.
//
// Each byte that cannot stand in an identifier becomes '_', and a name that starts with a digit gets a leading '_'. Keywords
// and names that become equal are refused by the front end, so that emitted names never differ from the user's by more than
// this.
#pragma once

#include <string>
#include <string_view>

namespace dalembert::ir {

// "/j1" → "_j1", "left-arm 2" → "left_arm_2", "3dof" → "_3dof". An empty name gives "_".
std::string identifier(std::string_view name);

// Whether the text is reserved by the language: a keyword up to C++20, of g++ or clang++ besides, or an alternative token such
// as `and`.
bool is_cpp_keyword(std::string_view text);

}  // namespace dalembert::ir
