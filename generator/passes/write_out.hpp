// Writing out: kernels on whole matrices as nodes of the scalar program.
//
// The runtime's loops over chains of coordinates pay where matrices are large. Of a small robot's factors a straight line has
// the elements that are not zero and nothing else, no matrix between two kernels is stored, and what one leaves
// unfinished the next one's operations hide.
#pragma once

#include "ir/algorithm.hpp"
#include "ir/coordinate_tree.hpp"
#include "ir/program.hpp"

namespace dalembert::passes {

// Adds them and takes the kernels out, with the arrays that nothing but they read. `program` is the algorithm's, unrolled, with
// an element for every place of its arrays that is not zero in every state, and it is the function's only section: another
// would read arrays of kernels. Products of whole matrices stay, unless `products` are to be written out as well: they take a
// fraction of the time in lanes of elements.
void write_out_kernels(ir::Algorithm& algorithm, ir::Program& program, const ir::CoordinateTree& tree, bool products = false);

}  // namespace dalembert::passes
