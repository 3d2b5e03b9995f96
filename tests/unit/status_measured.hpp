// What every way to v̇ and to M⁻¹ makes of a robot of the family: its status, and how many digits are right.
#pragma once

#include <string>
#include <vector>

#include "status_family.hpp"

namespace dalembert::status_family {

struct Way {
  std::string name;
  bool ok = false;
  int coordinate = -1;  // the status; of the generic engine unknown
  double digits = 0;    // of the largest element, right in all elements; read where ok
};
struct Measured {
  double condition = 0;  // of M, rows and columns divided by √M_ii
  bool exact = false;    // whether 50 digits can tell v̇
  std::vector<Way> ways;
};

Measured measure(const Shape& shape, double distance, unsigned seed);

}  // namespace dalembert::status_family
