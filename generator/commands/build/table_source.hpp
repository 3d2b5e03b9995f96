// The source of a library's function table (dalembert/function_table.hpp).
#pragma once

#include <string>

#include "commands/build/library.hpp"

namespace dalembert {

// Of all functions, one state after another; includes the parts' dynamics.hpp.
std::string table_source(const Library& library);

// Of the batches of these functions of one part; includes its batch.hpp.
std::string batch_table_source(const Library& library, const std::vector<size_t>& functions);

}  // namespace dalembert
