// The static oneTBB task graph beside the serial evaluation.
#pragma once

#include <string>

#include "backend/emit.hpp"

namespace dalembert::backend {

// The texts of tasks.hpp and tasks.cpp.
std::string tasks_header(const Folder& folder, const std::string& banner);
std::string tasks_source(const Folder& folder, const std::string& banner);

}  // namespace dalembert::backend
