// What tells the code of one robot and scene from another's; no protection against anyone.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "backend/output_files.hpp"

namespace dalembert::backend {

// FNV-1a, 64 bits, as 16 digits.
std::string hash_of(std::string_view bytes);

// Stands in files as they are written for the name of the inner namespace. The content, which is what functions do, gives it:
// those of the same names with other content have other symbols, and linked into one program none takes the other's place.
inline constexpr const char* code_mark = "code_of_these_files";
void name_by_content(std::vector<OutputFile>& files, std::string_view content);

// The text of a file under the name that another file has.
std::string named_as(std::string text, std::string_view other);

}  // namespace dalembert::backend
