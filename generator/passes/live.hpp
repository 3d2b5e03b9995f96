// What of an algorithm any result needs: one walk from the results back to the inputs.
#pragma once

#include <vector>

#include "ir/algorithm.hpp"

namespace dalembert::passes {

// By component, counted through all roles (ir::Algorithm::offsets()).
struct Live {
  std::vector<int> offset;
  std::vector<bool> body;         // of some body
  std::vector<bool> base;         // of the base
  std::vector<bool> coordinate;   // of the base's coordinates
  std::vector<bool> handed;       // what children hand on, at a body
  std::vector<bool> handed_base;  // … at the base

  std::size_t at(int role, int component) const {
    return static_cast<std::size_t>(offset[static_cast<std::size_t>(role)] + component);
  }
  bool operator==(const Live&) const = default;
};

Live live(const ir::Algorithm& algorithm, int base_coordinates);

}  // namespace dalembert::passes
