// The rolled form: limbs side by side in lanes, loops over their steps, matrices in blocks.
#pragma once

#include <string>
#include <vector>

#include "backend/code_text.hpp"

namespace dalembert::backend {

// The function in dynamics.cpp, and the headers it includes.
std::string rolled_source(const CodeInput& code, const Symbol& symbol);
std::vector<std::string> rolled_includes(const CodeInput& code);
// Pivots that the check whether M can be solved with looks at, those of slots without a joint among them.
int checked_pivots(const CodeInput& code);

// One of the functions that the evaluation calls one after another.
struct Stage {
  enum class Kind { base, segment, elements, results };
  Kind kind = Kind::base;
  int level = 0;             // base, segment
  int segment = -1;          // segment, elements
  std::string name;          // prepare, outwards_<segment>, inwards_<segment>, base, elements_<segment>, results
  bool reads_state = false;  // q, v and so on are its first arguments
  std::string body;
};
std::vector<Stage> rolled_stages(const CodeInput& code);
// Whether threads can sweep for themselves: what sweeps leave is in their scratch, and nothing goes on behind the elements but
// results.
bool can_sweep_apart(const CodeInput& code);
// Of the stage's declaration, and of its call by the function itself.
std::string arguments_of(const CodeInput& code, const Stage& stage);
std::string call_of(const CodeInput& code, const Stage& stage);

}  // namespace dalembert::backend
