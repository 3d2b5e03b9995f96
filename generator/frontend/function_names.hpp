// Names of the functions that a scene adds to the generated code.
#pragma once

#include <string>

#include "ir/scene.hpp"

namespace dalembert::frontend {

// Why no function of C++ can be called so, whatever the scene; empty when one can.
std::string fault_of_function_name(const std::string& name);

// A function whose own name, or one that is made of it (balance_mass_matrix, balance_status), the generated code has already.
struct TakenName {
  std::string function, taken;
};

// The first such of each function of the scene.
std::vector<TakenName> taken_names(const ir::Scene& scene);

}  // namespace dalembert::frontend
