// The rolled form: limbs side by side in lanes, loops over their steps, matrices in blocks.
#pragma once

#include <string>
#include <vector>

#include "backend/emit.hpp"

namespace dalembert::backend {

// The text of dynamics.cpp.
std::string rolled_source(const CodeInput& code, const std::string& banner);

// One of the functions that the evaluation calls one after another.
struct Stage {
  enum class Kind { base, segment, elements, results };
  Kind kind = Kind::base;
  int level = 0;             // base, segment
  int segment = -1;          // segment, elements
  std::string name;          // prepare, outwards_<segment>, inwards_<segment>, base, elements_<segment>, results
  bool reads_state = false;  // q and v are its first arguments
  std::string body;
};
std::vector<Stage> rolled_stages(const CodeInput& code);
// Of the function's declaration, and of its call in evaluate().
std::string arguments_of(const CodeInput& code, const Stage& stage);
std::string call_of(const CodeInput& code, const Stage& stage);

}  // namespace dalembert::backend
