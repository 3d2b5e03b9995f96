// The text of the emitted self-test: states and expected results as tables, and the calls that compare.
#pragma once

#include <string>
#include <vector>

#include "backend/emit.hpp"

namespace dalembert::backend {

// self_test.hpp and self_test.cpp. Needs of the folder no more than names, shapes and run-time inputs.
std::vector<OutputFile> self_test_files(const Folder& folder, const ir::SelfTest& test, const std::string& banner);

}  // namespace dalembert::backend
