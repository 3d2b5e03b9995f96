// Matrices of pairs in the rolled form (ir/pair_blocks.hpp): calls of the runtime's block products with the robot's own sizes
// and tables (runtime/include/dalembert/blocks.hpp, runs.hpp, long_limbs.hpp).
#pragma once

#include <string>

#include "backend/emit.hpp"

namespace dalembert::backend {

// How the elements of all matrices are made of their factors, as types.
std::string pairs_types(const CodeInput& code);

// Rows, lengths and slots of the segment's limbs and of the limbs above them.
std::string limb_tables(const CodeInput& code, size_t segment);

// Statements for the elements in the columns [begin, end) of the segment.
std::string elements_stage(const CodeInput& code, size_t segment);

// Where joints follow others: tables and statements that add their rows and columns to those of whom they follow
// (runtime/include/dalembert/columns.hpp). Empty where none does, or there is no matrix of pairs.
std::string following_tables(const CodeInput& code);
std::string following_statements(const CodeInput& code);

}  // namespace dalembert::backend
