// Functions of a robot whose loops are embedded: text around what the tree without them computes.
#pragma once

#include <string>

#include "backend/emit.hpp"

namespace dalembert::backend {

// Rows of linkages, and close_loops(); empty where there are none.
std::string linkage_structs(const CodeInput& code);
std::string closing_declaration(const CodeInput& code);
// Of a function that users call.
std::string embedded_statements(const CodeInput& code);
// A function of the tree without embedded loops, in a scope of its own: it has another nv.
std::string opened_scope(const CodeInput& code, const std::string& text);
// Where joints without a coordinate in v stand in q, for headers.
std::string dependent_joints(const CodeInput& code);

}  // namespace dalembert::backend
