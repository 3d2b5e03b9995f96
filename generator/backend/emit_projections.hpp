// Projections in lanes that run along rows, in either form (runtime/include/dalembert/projections.hpp).
#pragma once

#include <string>
#include <vector>

#include "backend/emit.hpp"

namespace dalembert::backend {

// Statements with their tables; empty where there is none.
std::string projection_statements(const CodeInput& code);

// Bodies whose columns lanes give, of a projection by its number; whether there are any.
const std::vector<ir::ProjectedBody>& projected_bodies(const CodeInput& code, size_t projection);
bool projects_by_rows(const CodeInput& code);

}  // namespace dalembert::backend
