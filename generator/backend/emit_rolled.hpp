// The rolled form: limbs side by side in lanes, loops over their steps, Phase III in blocks.
#pragma once

#include <string>

#include "backend/emit.hpp"

namespace dalembert::backend {

// The text of dynamics.cpp.
std::string rolled_source(const CodeInput& code, const std::string& banner);

// The arrays of struct Kept: Scalar name[components][slots], each at a multiple of 64 bytes.
struct KeptArray {
  std::string name;
  int components = 0;
  int slots = 0;
  std::string meaning;
};
std::vector<KeptArray> kept_arrays(const CodeInput& code);

// What the workspace keeps per slot: the definition of struct Kept.
std::string rolled_workspace(const CodeInput& code);

// The functions the evaluation is made of.
struct Stage {
  std::string name;       // prepare, outwards_<segment>, inwards_<segment>, base, elements_<segment>, results
  std::string arguments;  // of its declaration
  std::string call;       // its arguments in evaluate()
};
std::vector<Stage> rolled_stages(const CodeInput& code);

}  // namespace dalembert::backend
