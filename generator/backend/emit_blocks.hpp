// Phase III of the rolled form: calls of the runtime's block products with the robot's own sizes and tables.
#pragma once

#include <string>

#include "backend/emit.hpp"

namespace dalembert::backend {

// Rows, lengths and slots of the segment's limbs and of the limbs above them.
std::string limb_tables(const CodeInput& code, size_t segment);

// Whether the segment's elements can be computed a range of columns at a time: long limbs, whose blocks are loops.
bool elements_split(const ir::Segment& segment);

// Statements for the elements of M and C in the columns of steps [begin, end) of the segment.
std::string elements_stage(const CodeInput& code, size_t segment);

// Statements and tables for the wrench influence matrix; empty when it is not asked for.
std::string wrench_stage(const CodeInput& code);
std::string wrench_tables(const CodeInput& code);

}  // namespace dalembert::backend
