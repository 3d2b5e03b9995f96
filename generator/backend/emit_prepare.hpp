// The joints' coordinates, spread from q and v to the slots of their bodies.
#pragma once

#include <string>

#include "backend/emit.hpp"

namespace dalembert::backend {

// Statements that fill every kept role that is a joint's coordinate.
std::string prepare_statements(const CodeInput& code);
// The tables they read.
std::string prepare_tables(const CodeInput& code);
// Whether angles are gathered in an array of their own before their sines are taken.
bool needs_angles(const CodeInput& code);
// Whether the statements make sines or slides of q, and whether they spread coordinates as they are.
bool prepare_reads_q(const CodeInput& code);
bool prepare_spreads(const CodeInput& code);

// What the statements execute, sines of padding included.
ir::Operations prepare_operations(const CodeInput& code);

}  // namespace dalembert::backend
