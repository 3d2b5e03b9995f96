// Batches of an entry of the cache, compiled when they are asked for first.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace dalembert {

// The source of a part's table of batches, in the entry's folder of sources.
std::string batches_table_file(size_t part);

// Keeps beside an entry's sources how they are compiled, and by which generator they were made.
void write_compiler(const std::filesystem::path& entry, const std::vector<std::string>& compiler_and_flags);

}  // namespace dalembert
