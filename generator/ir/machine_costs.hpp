// What a machine takes for what calls are made of, as `dalembert calibrate` measures it, in place of the committed constants.
#pragma once

#include <string>
#include <vector>

namespace dalembert::ir {

// What threads cost beside what they compute, ns: how long one takes to come when it is asked, and by how much threads that
// divide work are not done at the same time.
struct ThreadCosts {
  double coming = 700, parting = 500;
};

struct MachineCosts {
  std::string machine, compiler;    // where and with what they were measured
  int lanes = 4;                    // doubles that a register holds
  std::vector<double> per_feature;  // ns, in the order of backend/estimate.hpp
  ThreadCosts threads;
  double error = 0,
         largest_error = 0;  // of the estimates of what was measured, relative: root of the mean square, and the worst
};

}  // namespace dalembert::ir
