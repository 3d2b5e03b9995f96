// Writing out: kernels on whole matrices as nodes of the scalar program.
//
// The runtime's loops over chains of coordinates pay where matrices are large. Of a small robot's factors a straight line has
// the elements that are not zero and nothing else, no matrix between two kernels is stored, and what one leaves
// unfinished the next one's operations hide.
#pragma once

#include <span>

#include "ir/algorithm.hpp"
#include "ir/coordinate_tree.hpp"
#include "ir/program.hpp"

namespace dalembert::passes {

// Up to so many coordinates products of whole matrices are written out too. Of larger trees they take a fraction of the time in
// lanes of elements.
inline constexpr int most_of_products = 4;

struct SectionBehind {
  const ir::Algorithm& algorithm;
  const ir::Program& program;
};

// Adds them and takes the kernels out, with the arrays that nothing but they read. `program` is the algorithm's, unrolled, with
// an element for every place of its arrays that is not zero in every state. Rows of constraints stay, and products of whole
// matrices unless they are of few coordinates; of a `whole` line nothing does.
// The sections behind become part of the first: what they take for dv/dt are nodes then, and what both need is there once.
// Returns false, all being left as it is, where a pivot may be missing in every state, where a whole line has a kernel that is
// called in any case or, of more than one section, something waits for rows of constraints.
bool write_out_kernels(ir::Algorithm& algorithm, ir::Program& program, const ir::CoordinateTree& tree, bool whole = false,
                       std::span<const SectionBehind> behind = {});

}  // namespace dalembert::passes
