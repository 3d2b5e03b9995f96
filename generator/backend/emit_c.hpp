// The interface for C and whatever calls C: c_api.h and c_api.cpp.
#pragma once

#include <string>

#include "backend/emit.hpp"

namespace dalembert::backend {

struct CText {
  std::string declarations, definitions;
};

// Calls, results, statuses and run-time inputs; batches are emit_batch.hpp's.
CText c_functions(const Folder& folder);

}  // namespace dalembert::backend
