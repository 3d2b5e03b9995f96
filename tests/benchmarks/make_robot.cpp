// Writes the URDF of a tree of equal branches (tree_text.hpp) to standard output:
//
//   make_robot JOINTS BRANCHES [MASSES LENGTHS]
#include <cstdio>
#include <cstdlib>

#include "tree_text.hpp"

int main(int argc, char** argv) {
  const bool extreme = argc == 5;
  const int joints = argc == 3 || extreme ? std::atoi(argv[1]) : 0, branches = joints ? std::atoi(argv[2]) : 0;
  const double masses = extreme ? std::atof(argv[3]) : 1, lengths = extreme ? std::atof(argv[4]) : 1;
  if (joints < 1 || branches < 1 || joints % branches != 0 || !(masses > 0) || !(lengths > 0)) {
    std::fprintf(stderr, "make_robot JOINTS BRANCHES [MASSES LENGTHS]: positive numbers, the first a multiple of the second\n");
    return 2;
  }
  std::fputs(dalembert::benchmarks::tree_text(joints, branches, masses, lengths).c_str(), stdout);
}
