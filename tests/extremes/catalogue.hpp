// The robots that hurt: one list, for the test and for the table in docs/exactness.md.
#pragma once

#include <string>
#include <vector>

namespace dalembert::extremes {

struct Robot {
  std::string name, what;
  std::string urdf;  // text
  bool floating = false;
  double ulp = 32;        // promised: of the largest element, worst of M, C, g, bias; in moderate states
  std::string why = {};   // where that is more than 32: the reason
  double normalised = 0;  // promised for M with row and column i divided by √M_ii, ulp; 0: nothing
  bool slow = false;      // left out of the test: exact results take minutes
};

std::vector<Robot> robots();

}  // namespace dalembert::extremes
