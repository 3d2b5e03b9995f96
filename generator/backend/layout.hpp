// Where joints stand in q and v, and in what order: for the headers.
#pragma once

#include <string>
#include <vector>

#include "backend/emit.hpp"

namespace dalembert::backend {

// Those that have a coordinate of their own.
std::vector<const ir::Body*> own_coordinates(const CodeInput& code);

// What q and v hold, in words.
std::string position_layout(const CodeInput& code);
std::string velocity_layout(const CodeInput& code);

// For C++: a comment above the joints' enumerators, the expression by which q_index() knows a joint's place, and what
// integrators ask for.
std::string joint_indices(const CodeInput& code);
std::string position_index(const CodeInput& code);
std::string quaternion_joints(const CodeInput& code);

// For C: sizes, and where joints stand, as enumerators.
std::string c_layout(const CodeInput& code);

}  // namespace dalembert::backend
