// What the guard goes by besides pivots.
#pragma once

#include "passes/builder.hpp"

namespace dalembert::passes {

// Where no quantity made M's factors: V and J of articulated bodies. To be called when all quantities are described.
void complete_guard(Builder& builder);

}  // namespace dalembert::passes
