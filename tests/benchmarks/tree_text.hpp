// URDFs of trees of equal branches, such as the paper's second experiment sweeps; one branch makes a chain.
#pragma once

#include <string>

namespace dalembert::benchmarks {

// Every link is a bar of 2 kg along x with a generic, turned inertia, so that no structural zero flatters anyone; axes go z, y,
// x, z, ... down each branch. `joints`: a multiple of `branches`. `masses` and `lengths` make extremes: the last link's mass
// and length as a multiple of the base's, those between growing geometrically.
std::string tree_text(int joints, int branches, double masses = 1, double lengths = 1);

}  // namespace dalembert::benchmarks
