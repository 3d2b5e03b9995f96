// Projections in lanes that run along rows, in either form (runtime/include/dalembert/projections.hpp).
#pragma once

#include <string>

#include "backend/emit.hpp"

namespace dalembert::backend {

// Statements with their tables; empty where there is none.
std::string projection_statements(const CodeInput& code);
// Whether there are any, of one projection or of all.
bool projects_by_rows(const CodeInput& code, const ir::Projection& projection);
bool projects_by_rows(const CodeInput& code);

// Of the rows of the base's coordinates, of all bodies: the rest of rolled code.
ir::Operations base_row_operations(const CodeInput& code, const ir::Projection& projection);

// Rows that they compute of a projection, by registers of `lanes`; and the registers.
struct RowCounts {
  long rows = 0, registers = 0;
  long added = 0;          // of the rows: those that are added to others
  long base_elements = 0;  // of the base's rows, one number at a time
};
RowCounts row_counts(const CodeInput& code, const ir::Projection& projection, int lanes);

}  // namespace dalembert::backend
