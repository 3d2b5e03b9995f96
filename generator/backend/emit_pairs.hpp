// Matrices of pairs in the rolled form: calls of the runtime's block products with the robot's own sizes and
// tables (runtime/include/dalembert/blocks.hpp).
#pragma once

#include <string>
#include <vector>

#include "backend/emit.hpp"

namespace dalembert::backend {

// Matrices of pairs that have the same rows and columns of the robot, and are filled together.
struct PairsOfRows {
  std::vector<size_t> pairs;     // of the algorithm, in order
  const ir::OutputArray* array;  // the first one's: what is said of rows holds for all
  std::vector<int> rows;         // per body: its row of that array; −1: not asked for
  std::string suffix;            // of names that are theirs; the first ones' is empty
};
std::vector<PairsOfRows> pairs_by_rows(const CodeInput& code);

// How the elements of all matrices are made of their factors, as a type.
std::string pairs_types(const CodeInput& code);

// Rows, lengths and slots of the segment's limbs and of the limbs above them.
std::string limb_tables(const CodeInput& code, size_t segment);

// Whether the elements of a segment's limbs are computed limb after limb, lanes along a limb, and not limbs in lanes.
bool limb_after_limb(const CodeInput& code, const ir::Segment& segment);

// Whether the segment's elements can be computed a range of columns at a time: their blocks are loops. How many columns there
// are: limb after limb those of all, else steps.
bool elements_split(const CodeInput& code, const ir::Segment& segment);
int split_columns(const CodeInput& code, const ir::Segment& segment);

// Statements for the elements in the columns [begin, end) of the segment.
std::string elements_stage(const CodeInput& code, size_t segment);

// Elements of one matrix that the statements compute for a segment, with those that padding adds: above the diagonal with it,
// and below. Limbs alone run along rows, `lanes` at a time.
struct ElementCounts {
  long above = 0, below = 0;
  long added_to_zero = 0;  // of these: whose sum starts from zero instead of its first product
};
ElementCounts element_counts(const CodeInput& code, size_t segment, const ir::Pairs& pairs, int lanes);

}  // namespace dalembert::backend
