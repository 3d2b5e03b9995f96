// batch.hpp, batch.cpp and batch_tasks.hpp: every function at many states in one call, a state in each lane of a register.
#pragma once

#include <string>
#include <vector>

#include "backend/emit.hpp"

namespace dalembert::backend {

// The files; none where the scene asks for no batches.
std::vector<OutputFile> batch_files(const Folder& folder, const std::string& banner);

// Names of the functions that compute states in lanes; none where the results of one are more than batches take.
std::vector<std::string> functions_in_lanes(const Folder& folder);

// What stands of them in c_api.h.
std::string batch_c_declarations(const Folder& folder);

}  // namespace dalembert::backend
