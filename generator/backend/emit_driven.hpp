// Matrices of pairs in the rolled form when some joints are driven by others: their rows and columns stand apart, and are added
// to their drivers' at the end (runtime/include/dalembert/columns.hpp).
#pragma once

#include <string>

#include "backend/emit.hpp"

namespace dalembert::backend {

// Tables and statements; empty where no joint is driven, or there is no matrix of pairs.
std::string driven_tables(const CodeInput& code);
std::string driven_statements(const CodeInput& code);

// Additions that the statements execute.
long driven_additions(const CodeInput& code);

}  // namespace dalembert::backend
